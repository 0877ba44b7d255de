// format.ts - what `stance view` writes into the page, and what the engine tells of itself: types of the JSON. The C
// side is view_write.c and wasm/*.c.

export type Word = string;
export type BlockType = 'u8' | 'u32' | 'f32' | 'f64';

// An axis of the file; of words its values are 0, 1, 2 ...
export interface FileAxis {
  path: string;
  unit: string;
  text: string;
  count: number;
  words: Word[] | null;
  offset: boolean;
  values: number[];
}

// A path that varies from point to point of a sample.
export interface Varied {
  path: string;
  unit: string;
  text: string;
  words: Word[] | null;
  values: number[];
}

export interface Answer {
  name: string;
  unit: string;
  text: string;
  type: 'code' | 'count' | 'number';
  words: Word[] | null;
  block?: string | null; // null: not carried
}

export interface Kind {
  name: string;
  colour: string;
}

export interface Series {
  name: string;
  x: (number | null)[];
  y: (number | null)[];
  low?: (number | null)[] | null;
  high?: (number | null)[] | null;
  lines: boolean;
}

export interface ChartAxis {
  label: string;
  unit: string;
  log: boolean;
  words?: Word[] | null; // names of the places 0, 1, 2 ...
}

export interface Chart {
  title: string;
  text: string;
  x: ChartAxis;
  y: ChartAxis;
  series: Series[];
}

export interface Head {
  format: number;
  program: string; // that wrote the page
  revision: string;
  file_program: string; // that computed the file
  file_revision: string;
  file: string;
  title: string;
  date: string;
  scenario: string; // YAML
  wire: string | null; // the same for the engine, see wire.ts; null: nothing can be simulated
  command_file: string;
  cases: number;
  single: boolean;
  index: number;
  axes: FileAxis[]; // row-major, the last one fastest
  sample: number; // which of them is a sample's points, or -1
  varied: Varied[];
  designs: { count: number; numbers: number };
  kinds: Kind[];
  answers: Answer[];
  checksums: boolean;
  left_out: string[];
  engine: boolean; // the page carries one
  stored: number;
  number: number; // of the scenario, where the file was made from several: block 'number' has each case's; else -1
  blocks: Record<string, { type: BlockType; count: number }>;
  recorded: number[];
  charts?: Chart[];
}

// A number or word of the scenario that can be changed.
export interface Field {
  path: string;
  text: string;
  unit: string;
  type: 'number' | 'integer' | 'word';
  value: number | string | null; // null: none is given
  low: number | null;
  high: number | null;
  lowOpen: boolean;
  highOpen: boolean;
  words: Word[] | null;
  design: boolean; // the controller's design depends on it
  swept: boolean;
}

export interface Named {
  name: string;
  unit: string;
}

// What the engine says of a view: the file's scenario with changes.
export interface ViewText {
  scene: string;
  title: string;
  method: string;
  step: number;
  stop_time: number;
  law: string;
  designed: boolean;
  coordinates: Named[];
  actuators: Named[];
  contacts: string[]; // with the ground
  axes: { paths: string[]; count: number }[];
  cases: number;
  fields: Field[];
}

// A case that was simulated with its trajectory.
export interface PlayText {
  rows: number;
  interval: number; // s
  step: number;
  figure: number; // points per row
  contacts: number; // per row: those with the ground, then stops of joints
  kind: number;
  checksum: number;
  slope: number; // rad: how the ground falls along x in the frame of the figure
  ground: { since: number | null; points: number[] }[]; // plates, if there are: x, z of a line, from a time on (null: always), s
  answers: (number | null)[];
}

// Numbers of play_numbers(): a row per time; forces (normal, tangential), points (x, z), of actuators the place and, of
// slides, the direction.
export interface Trajectory {
  time: Float64Array;
  position: Float64Array;
  velocity: Float64Array;
  torque: Float64Array;
  force: Float64Array;
  gap: Float64Array;
  figure: Float64Array;
  contact: Float64Array;
  actuator: Float64Array;
  energy: Float64Array;
}
