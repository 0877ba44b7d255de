// worker.ts - a worker of the page: an engine, and one call after the other.
import { Engine, type FileParts } from './engine';
import type { View } from './state';
import { Refusal } from './wire';

export type Call = 'describe' | 'values' | 'run' | 'play' | 'refineBegin' | 'refineAsk' | 'refineTell' | 'refineEnd';
export interface Request {
  id: number;
  view: View | null; // null: the one that is open
  call: Call;
  arguments: unknown[];
}
export interface Reply {
  id: number;
  result?: unknown;
  columns?: unknown;
  problem?: string;
}

let module: WebAssembly.Module;
let file: FileParts;
let engine: Engine | null = null;

self.onmessage = (event: MessageEvent<Request | { module: WebAssembly.Module; file: FileParts }>): void => {
  if ('module' in event.data) {
    ({ module, file } = event.data);
    return;
  }
  const { id, view, call, arguments: given } = event.data;
  let reply: Reply;
  try {
    engine ??= new Engine(module, file);
    if (view) engine.open(view);
    reply = { id, result: (engine[call] as (...a: unknown[]) => unknown).apply(engine, given), columns: engine.columns };
  } catch (problem) {
    const message = problem instanceof Error ? problem.message : String(problem);
    const refused = problem instanceof Refusal;
    if (!refused) engine = null;
    reply = { id, problem: refused ? message : `the engine failed: ${message}` };
  }
  self.postMessage(reply);
};
