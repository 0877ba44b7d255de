// engine.ts - the engine as a WebAssembly instance: numbers and texts in and out of its memory. Its exports are those of
// wasm/page.c. One instance serves one worker.
import type { Answer, PlayText, Trajectory, ViewText } from './format';
import { pathOf, textOf, type View } from './state';
import { Refusal, wireOf } from './wire';

// What every instance is told of the file.
export interface FileParts {
  wire: string;
  single: number; // place of a single case in its sweep, -1: a sweep
  axes: Float64Array[]; // exact values, count times paths
  designs: { count: number; numbers: Float64Array; status: Uint8Array } | null;
  stored: number; // which answers the checksum covers
  number: number; // and the scenario's number, -1: not that
  law: Uint8Array | null; // a law of the user's own, as a module of its own
}

export interface Results {
  kinds: Uint8Array;
  checksums: Uint32Array;
  answers: Float32Array; // a row per case
}

export interface Play {
  text: PlayText;
  rows: Trajectory;
  values: Record<string, number | string | null>;
}

type Exports = Record<string, (...numbers: number[]) => number> & { memory: WebAssembly.Memory };

const decoder = new TextDecoder();
const encoder = new TextEncoder();

// The few system calls of its C library: there are no files, no arguments and no environment.
function systemCalls(module: WebAssembly.Module, memory: () => DataView, more: Record<string, (...p: number[]) => number> = {}): WebAssembly.Imports {
  const nothing = (count: number, size: number): number => {
    memory().setUint32(count, 0, true);
    memory().setUint32(size, 0, true);
    return 0;
  };
  const calls: Record<string, (...p: number[]) => number> = {
    proc_exit: (code) => {
      throw new Error(`the engine stopped with code ${code}`);
    },
    fd_write: (_fd, vectors, count, written) => {
      let bytes = 0;
      for (let k = 0; k < count; k++) bytes += memory().getUint32(vectors + 8 * k + 4, true);
      memory().setUint32(written, bytes, true);
      return 0;
    },
    environ_sizes_get: nothing,
    args_sizes_get: nothing,
    ...more,
  };
  const imports: WebAssembly.Imports = {};
  for (const { module: from, name, kind } of WebAssembly.Module.imports(module))
    if (kind === 'function') (imports[from] ??= {})[name] = calls[name] ?? ((): number => 8); // EBADF
  return imports;
}

// A law of the user's own. It is called with copies of the numbers at `at` in the engine's memory, the last of which it
// changes; what it does wrong is the case's failure.
class Law {
  private readonly e: Exports;
  readonly size: number;

  constructor(bytes: Uint8Array) {
    const module = new WebAssembly.Module(bytes as BufferSource);
    this.e = new WebAssembly.Instance(module, systemCalls(module, () => new DataView(this.e.memory.buffer))).exports as unknown as Exports;
    this.e._initialize?.();
    this.size = this.e.memory_size();
  }

  call(engine: WebAssembly.Memory, at: number, count: number): number {
    const theirs = new Float64Array(engine.buffer, at, count);
    const own = new Float64Array(this.e.memory.buffer, this.e.room(), count);
    own.set(theirs);
    try {
      this.e.call();
    } catch {
      return 0;
    }
    theirs.set(own);
    return 1;
  }
}

export class Engine {
  private readonly e: Exports;
  private view: View | null = null;
  columns: Answer[] = [];

  constructor(module: WebAssembly.Module, file: FileParts) {
    const memory = (): DataView => new DataView(this.e.memory.buffer);
    const law = file.law && new Law(file.law);
    const calls = { law: (at: number, count: number): number => law?.call(this.e.memory, at, count) ?? 0 };
    this.e = new WebAssembly.Instance(module, systemCalls(module, memory, calls)).exports as unknown as Exports;
    this.e._initialize?.();
    if (law) this.e.file_law(law.size);
    this.lend([encoder.encode(file.wire + '\0')], ([p]) => this.must(this.e.file_open(p, file.single)));
    file.axes.forEach((values, k) => this.lend([values], ([p]) => this.must(this.e.file_axis(k, p, values.length))));
    const { designs } = file;
    if (designs) this.lend([designs.numbers, designs.status], ([numbers, status]) => this.must(this.e.file_designs(numbers, status, designs.count)));
    this.e.file_stored(file.stored, file.number);
    this.columns = JSON.parse(this.text(this.e.answers_text())) as Answer[];
  }

  // ---- memory ----
  private text(p: number): string {
    const bytes = new Uint8Array(this.e.memory.buffer);
    return decoder.decode(bytes.slice(p, bytes.indexOf(0, p)));
  }

  private must(done: number): number {
    if (!done) throw new Refusal(this.text(this.e.message()) || 'the engine cannot do this');
    return done;
  }

  // Copies arrays into its memory for the time of a call.
  private lend<T>(arrays: { buffer: ArrayBufferLike; byteOffset: number; byteLength: number }[], use: (places: number[]) => T): T {
    const places = arrays.map((a) => this.e.alloc(Math.max(8, a.byteLength)));
    try {
      arrays.forEach((a, k) => new Uint8Array(this.e.memory.buffer).set(new Uint8Array(a.buffer, a.byteOffset, a.byteLength), places[k]));
      return use(places);
    } finally {
      for (const p of places) this.e.release(p);
    }
  }

  private doubles = (p: number, count: number): Float64Array => new Float64Array(this.e.memory.buffer, p, count).slice();

  // ---- what it does; each call names the view that it is of ----
  open(view: View): void {
    if (this.view && JSON.stringify(this.view) === JSON.stringify(view)) return;
    this.view = null;
    const sets = encoder.encode(view.map((s) => `${pathOf(s)}=${wireOf(textOf(s))}\0`).join('') + '\0');
    this.lend([sets], ([p]) => this.must(this.e.view_open(p)));
    this.view = view;
  }

  describe(): ViewText {
    return JSON.parse(this.text(this.e.view_text())) as ViewText;
  }

  values(index: number): Record<string, number | string | null> {
    return JSON.parse(this.text(this.e.case_values(index))) as Record<string, number | string | null>;
  }

  run(indices: Float64Array): Results {
    const n = indices.length;
    const kinds = new Uint8Array(n);
    const checksums = new Uint32Array(n);
    const answers = new Float64Array(n * this.columns.length);
    return this.lend([indices, kinds, checksums, answers], ([i, k, c, a]) => {
      this.must(this.e.run(i, n, k, c, a));
      const { buffer } = this.e.memory;
      return {
        kinds: new Uint8Array(buffer, k, n).slice(), checksums: new Uint32Array(buffer, c, n).slice(),
        answers: Float32Array.from(new Float64Array(buffer, a, answers.length)),
      };
    });
  }

  play(index: number, most: number): Play {
    this.must(this.e.play(index, 0, most));
    const text = JSON.parse(this.text(this.e.play_text())) as PlayText;
    const { coordinates, actuators } = this.describe();
    const numbers = (which: number, columns: number): Float64Array => this.doubles(this.e.play_numbers(which), text.rows * columns);
    const [q, m, k] = [coordinates.length, actuators.length, text.contacts];
    const rows: Trajectory = {
      time: numbers(0, 1), position: numbers(1, q), velocity: numbers(2, q), torque: numbers(3, m), force: numbers(4, 2 * k), gap: numbers(5, k),
      figure: numbers(6, 2 * text.figure), contact: numbers(7, 2 * k), actuator: numbers(8, 4 * m), energy: numbers(9, 1),
    };
    return { text, rows, values: this.values(index) };
  }

  refineBegin(start: number, margin: number): void {
    this.must(this.e.refine_begin(start, margin));
  }

  // Cases to be simulated next; none: all labels are known. All of them must have been told before it is asked again.
  refineAsk(room: number): Float64Array {
    return this.lend([new Float64Array(room)], ([p]) => this.doubles(p, this.e.refine_ask(p, room)));
  }

  refineTell(indices: Float64Array, kinds: Uint8Array): void {
    this.lend([indices, kinds], ([i, k]) => this.e.refine_tell(i, k, indices.length));
  }

  refineEnd(cases: number): { kinds: Uint8Array; inferred: Uint8Array } {
    return this.lend([new Uint8Array(cases), new Uint8Array(cases)], ([k, i]) => {
      this.e.refine_end(k, i);
      const { buffer } = this.e.memory;
      return { kinds: new Uint8Array(buffer, k, cases).slice(), inferred: new Uint8Array(buffer, i, cases).slice() };
    });
  }
}
