// compute.ts - a map computed in the page: coarse first, on all workers; as sweep.refine does, only where outcomes differ,
// or every case.
import type { Results } from './engine';
import { Computed } from './layers';
import type { Pool } from './pool';

export interface Progress {
  simulated: number;
  asked: number; // cases that are to be simulated, as far as is known
  seconds: number;
  stopped?: boolean;
}

const batch_seconds = 0.05; // that a worker is busy with one batch
// Most cells of the coarse lattice along an axis, and how many cells around a mixed one are refined with it: none beside a
// lattice that has every other case.
const refine_start = 32;
const refine_margin = (layer: Computed): number => (Math.max(layer.grid!.nx, layer.grid!.ny) > 2 * refine_start ? 1 : 0);

// Of a grid the coarse lattices first.
function coarseFirst(layer: Computed): number[] {
  const { grid } = layer;
  if (!grid) return Array.from({ length: layer.count }, (_, n) => n);
  const order: number[] = [];
  const level = (i: number): number => (i === 0 ? 32 : Math.min(32, i & -i));
  const groups = new Map<number, number[]>([32, 16, 8, 4, 2, 1].map((s) => [s, []]));
  for (let n = 0; n < layer.count; n++) groups.get(Math.min(level(n % grid.nx), level(Math.floor(n / grid.nx))))!.push(n);
  for (const list of groups.values()) order.push(...list);
  return order;
}

// Fills the layer; ends early when the signal says so. What went wrong is thrown.
export async function compute(pool: Pool, layer: Computed, all: boolean, signal: AbortSignal, progress: (p: Progress) => void): Promise<void> {
  const begin = performance.now();
  const columns = layer.columns.length;
  let asked = 0;
  let size = 4;

  const simulate = async (cases: number[]): Promise<void> => {
    asked += cases.length;
    let at = 0;
    const one = async (): Promise<void> => {
      while (at < cases.length && !signal.aborted) {
        const some = cases.slice(at, (at += Math.min(size, Math.max(2, Math.ceil((cases.length - at) / pool.size)))));
        const from = performance.now();
        const r = await pool.ask<Results>(layer.view, 'run', [Float64Array.from(some, layer.index)]);
        const seconds = (performance.now() - from) / 1000;
        size = Math.max(2, Math.min(1024, Math.round(0.5 * size + 0.5 * ((some.length * batch_seconds) / Math.max(1e-4, seconds)))));
        some.forEach((n, k) => {
          layer.kinds[n] = r.kinds[k];
          layer.checksums[n] = r.checksums[k];
          layer.answers.set(r.answers.subarray(k * columns, (k + 1) * columns), n * columns);
        });
        layer.done += some.length;
        layer.simulated += some.length;
        progress({ simulated: layer.simulated, asked, seconds: (performance.now() - begin) / 1000 });
      }
    };
    await Promise.all(Array.from({ length: pool.size }, one));
  };

  if (all || !layer.grid) await simulate(coarseFirst(layer));
  else {
    await pool.refine(layer.view, 'refineBegin', [refine_start, refine_margin(layer)]);
    // What another map has begun to refine is not asked for.
    while (!signal.aborted) {
      const wanted = await pool.refine<Float64Array>(null, 'refineAsk', [layer.count]);
      if (wanted.length === 0 || signal.aborted) break;
      await simulate([...wanted].map(layer.of));
      if (signal.aborted) break;
      await pool.refine(null, 'refineTell', [wanted, Uint8Array.from(wanted, (i) => layer.kinds[layer.of(i)])]);
    }
    if (!signal.aborted) {
      const end = await pool.refine<{ kinds: Uint8Array; inferred: Uint8Array }>(null, 'refineEnd', [layer.count]);
      layer.inferred = new Uint8Array(layer.count);
      for (let n = 0; n < layer.count; n++) {
        layer.kinds[n] = end.kinds[layer.index(n)];
        layer.inferred[n] = end.inferred[layer.index(n)];
      }
      layer.done = layer.count;
    }
  }
  progress({ simulated: layer.simulated, asked, seconds: (performance.now() - begin) / 1000 });
}
