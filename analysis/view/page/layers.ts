// layers.ts - what a map shows: cases of the file, or cases computed in the page, each with its places on the map.
import type { Data } from './data';
import type { Answer } from './format';
import type { Scale } from './scales';
import type { View } from './state';

export const unknown = 255; // kind of a case that is not there yet
// Of one that the file has not; of one that has no outcome, or whose file has not kept it: behind the outcomes.
const others = { pending: -1, done: -1 };
export function numberKinds(kinds: { name: string }[]): void {
  for (const name of ['pending', 'done'] as const) others[name] = kinds.findIndex((k) => k.name === name);
}

export type Get = (n: number) => number;

export interface Layer {
  view: View;
  computed: boolean;
  count: number;
  kinds: Uint8Array; // of each of its cases
  inferred: Uint8Array | null;
  // A grid of nx times ny cases, x fastest, the first at (x0, y0) and the last at (x1, y1); or points at places.
  grid: { nx: number; ny: number; x0: number; x1: number; y0: number; y1: number } | null;
  px: Get;
  py: Get;
  index: Get; // flat index in the view's sweep
  of(index: number): number; // the inverse, -1: not here
  answer(a: Answer): Promise<Get | null>; // null: not carried
  done: number; // cases that are known
  simulated: number;
}

const edge = (from: number, to: number, n: number, i: number): number => (n > 1 ? from + ((to - from) * i) / (n - 1) : from);

export function gridPlaces(grid: NonNullable<Layer['grid']>): { px: Get; py: Get } {
  return {
    px: (n) => edge(grid.x0, grid.x1, grid.nx, n % grid.nx),
    py: (n) => edge(grid.y0, grid.y1, grid.ny, Math.floor(n / grid.nx)),
  };
}

// Cases of the file on a map of two scales (of one: y null), where other axes are `at` places.
export async function fileLayer(data: Data, x: Scale | null, y: Scale | null, at: number[]): Promise<Layer> {
  const all = (await data.block('kind')) as Uint8Array;
  const allInferred = data.has('inferred') ? ((await data.block('inferred')) as Uint8Array) : null;
  // Of the axes that the scales move along, the first is fastest.
  const moved = [x, y].map((s) => s?.axis ?? -1).filter((a, k, list) => a >= 0 && list.indexOf(a) === k);
  const base = data.axes.reduce((sum, a, k) => sum + (moved.includes(k) ? 0 : a.stride * at[k]), 0);
  const [first, second] = moved.map((k) => data.axes[k]);
  const nx = first?.count ?? 1;
  const ny = second?.count ?? 1;
  const count = nx * ny;
  const index: Get = (n) => base + (n % nx) * (first?.stride ?? 0) + Math.floor(n / nx) * (second?.stride ?? 0);
  const kinds = new Uint8Array(count);
  const inferred = allInferred ? new Uint8Array(count) : null;
  for (let j = 0, n = 0; j < ny; j++)
    for (let i = 0, c = base + j * (second?.stride ?? 0); i < nx; i++, n++, c += first?.stride ?? 0) {
      kinds[n] = all[c];
      if (inferred) inferred[n] = allInferred![c];
    }
  const scattered = (x?.varied ?? -1) >= 0 || (y?.varied ?? -1) >= 0;
  const place = (s: Scale | null): Get => {
    if (!s) return () => 0;
    const step = s.axis === moved[0] ? (n: number): number => n % nx : (n: number): number => Math.floor(n / nx);
    return s.varied < 0 ? step : (n) => s.place(s.values[step(n)]);
  };
  return {
    view: [], computed: false, count, kinds, inferred, index,
    grid: scattered ? null : { nx, ny, x0: 0, x1: nx - 1, y0: 0, y1: ny - 1 },
    px: place(x), py: place(y),
    of: (i) => {
      const n = (first ? Math.floor(i / first.stride) % nx : 0) + nx * (second ? Math.floor(i / second.stride) % ny : 0);
      return index(n) === i ? n : -1;
    },
    answer: async (a) => {
      if (!a.block) return null;
      const numbers = await data.block(a.block);
      return (n) => numbers[index(n)];
    },
    done: count,
    simulated: count,
  };
}

// Cases to be computed: the same places as `like`, or a grid of their own. Answers of a case stand in a row.
export class Computed implements Layer {
  computed = true;
  kinds: Uint8Array;
  inferred: Uint8Array | null = null;
  checksums: Uint32Array;
  answers: Float32Array;
  px: Get;
  py: Get;
  done = 0;
  simulated = 0;

  constructor(
    readonly view: View,
    readonly count: number,
    readonly columns: Answer[],
    readonly grid: Layer['grid'],
    readonly index: Get,
    readonly of: (index: number) => number,
    places: { px: Get; py: Get },
  ) {
    this.kinds = new Uint8Array(count).fill(unknown);
    this.checksums = new Uint32Array(count);
    this.answers = new Float32Array(count * columns.length).fill(NaN);
    this.px = places.px;
    this.py = places.py;
  }

  async answer(a: Answer): Promise<Get | null> {
    const column = this.columns.findIndex((c) => c.name === a.name);
    return column < 0 ? null : (n) => (this.inferred?.[n] ? NaN : this.answers[n * this.columns.length + column]);
  }
}

// Cases whose kind differs from that of the file's nearest case: n of the layer -> "from" * 16 + "to", 0: the same.
export function differences(file: Layer, now: Layer): { of: Uint8Array; counts: Map<number, number>; compared: number } {
  const of = new Uint8Array(now.count);
  const counts = new Map<number, number>();
  let compared = 0;
  const same = JSON.stringify(file.grid) === JSON.stringify(now.grid);
  for (let n = 0; n < now.count; n++) {
    let m = n;
    if (!same && file.grid) {
      const i = Math.round(now.px(n));
      const j = Math.round(now.py(n));
      if (i < 0 || j < 0 || i >= file.grid.nx || j >= file.grid.ny) continue;
      m = i + j * file.grid.nx;
    }
    const from = file.kinds[m];
    const to = now.kinds[n];
    if (from === unknown || to === unknown || from === others.pending || to === others.pending || (from === others.done && to < others.done)) continue;
    compared++;
    if (from === to) continue;
    of[n] = from * 16 + to;
    counts.set(of[n], (counts.get(of[n]) ?? 0) + 1);
  }
  return { of, counts, compared };
}
