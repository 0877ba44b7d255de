// pool.ts - the page's workers: one for each core that take what comes next, and one that keeps what a refinement knows.
import { unpack, type Data } from './data';
import type { FileParts } from './engine';
import type { Answer } from './format';
import type { View } from './state';
import type { Call, Reply, Request } from './worker';

declare const WORKER: string; // the program of worker.ts, from build.mjs

class Client {
  private worker: Worker;
  private waiting = new Map<number, { resolve: (r: Reply) => void; reject: (e: Error) => void }>();
  private next = 0;

  constructor(source: string, module: WebAssembly.Module, file: FileParts) {
    this.worker = new Worker(source);
    this.worker.onmessage = (e: MessageEvent<Reply>) => {
      const { id, problem } = e.data;
      const one = this.waiting.get(id);
      this.waiting.delete(id);
      if (problem !== undefined) one?.reject(new Error(problem));
      else one?.resolve(e.data);
    };
    this.worker.onerror = (e) => {
      e.preventDefault();
      for (const one of this.waiting.values()) one.reject(new Error(e.message || 'a worker of the page failed'));
      this.waiting.clear();
    };
    this.worker.postMessage({ module, file });
  }

  ask(view: View | null, call: Call, given: unknown[]): Promise<Reply> {
    const id = ++this.next;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, view, call, arguments: given } satisfies Request);
    });
  }
}

interface Job {
  view: View | null;
  call: Call;
  given: unknown[];
  resolve: (r: Reply) => void;
  reject: (e: unknown) => void;
}

// What a browser, or a page, lacks to simulate, in a sentence; null: nothing.
export function lacking(engine: boolean): string | null {
  // A module with one simd128 instruction.
  const simd = [0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11];
  const can = typeof WebAssembly === 'object' && WebAssembly.validate(new Uint8Array(simd)) && typeof Worker === 'function';
  if (can && engine) return null;
  return can
    ? 'This page was made without the engine: it shows what the file has, and simulates nothing.'
    : 'To simulate, this page needs a browser with WebAssembly and its 128-bit vectors: Chrome or Edge 91, Firefox 89, Safari 16.4, or later.';
}

export class Pool {
  columns: Answer[] = []; // of all answers, known after the first reply
  private constructor(
    private readonly free: Client[],
    private readonly desk: Client,
    readonly size: number,
  ) {}
  private queue: Job[] = [];

  static async make(data: Data): Promise<Pool> {
    const { head } = data;
    const bytes = await unpack('engine');
    const doubles = async (name: string): Promise<Float64Array> => (await data.block(name)) as Float64Array;
    const file: FileParts = {
      wire: head.wire ?? '',
      single: head.single ? head.index : -1,
      axes: await Promise.all(head.axes.map((_, k) => doubles(`axis-${k}`))),
      designs: data.has('designs') ? { count: head.designs.count, numbers: await doubles('designs'), status: (await data.block('design-status')) as Uint8Array } : null,
      stored: head.stored,
      number: head.number,
      law: data.has('law') ? ((await data.block('law')) as Uint8Array) : null,
    };
    const module = await WebAssembly.compile(bytes);
    const source = URL.createObjectURL(new Blob([WORKER], { type: 'text/javascript' }));
    const size = Math.max(1, Math.min(16, navigator.hardwareConcurrency || 2));
    const clients = Array.from({ length: size + 1 }, () => new Client(source, module, file));
    return new Pool(clients.slice(1), clients[0], size);
  }

  // Of a view, from the next worker that is free; `first`: before all that waits.
  async ask<T>(view: View, call: Call, given: unknown[] = [], first = false): Promise<T> {
    const reply = await new Promise<Reply>((resolve, reject) => {
      this.queue[first ? 'unshift' : 'push']({ view, call, given, resolve, reject });
      this.serve();
    });
    this.columns = reply.columns as Answer[];
    return reply.result as T;
  }

  private serve(): void {
    while (this.free.length && this.queue.length) {
      const client = this.free.pop()!;
      const job = this.queue.shift()!;
      client
        .ask(job.view, job.call, job.given)
        .then(job.resolve, job.reject)
        .finally(() => {
          this.free.push(client);
          this.serve();
        });
    }
  }

  // Of the worker that refines.
  async refine<T>(view: View | null, call: Call, given: unknown[] = []): Promise<T> {
    return (await this.desk.ask(view, call, given)).result as T;
  }
}
