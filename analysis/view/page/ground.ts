// ground.ts - uneven ground, as lines: what is there at a time, how high it is.
import type { PlayText } from './format';

// x and z of its points, in turn; null: it is even.
export function plates(text: PlayText, time: number): number[] | null {
  return text.ground.filter((g) => (g.since ?? -Infinity) <= time + 1e-9).at(-1)?.points ?? null;
}

// Height at x.
export function height(points: number[], x: number): number {
  let low = 0;
  let high = points.length / 2 - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (points[2 * middle] <= x) low = middle;
    else high = middle;
  }
  const [x0, z0, x1, z1] = [points[2 * low], points[2 * low + 1], points[2 * high], points[2 * high + 1]];
  return x1 > x0 ? z0 + Math.min(1, Math.max(0, (x - x0) / (x1 - x0))) * (z1 - z0) : z0;
}

// Mean height about x.
export function meanHeight(points: number[], x: number, half: number): number {
  const places = 32;
  let sum = 0;
  for (let i = 0; i < places; i++) sum += height(points, x + half * ((2 * i + 1) / places - 1));
  return sum / places;
}
