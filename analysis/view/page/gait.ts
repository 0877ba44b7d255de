// gait.ts - what a walker leaves behind and what tells its legs apart: footfalls, from the forces of a trajectory, and the
// discs of its stick figure.
import type { Trajectory } from './format';

const pause = 0.04; // s without a force after which another one is a footfall
const sides = 12; // of the polygon that is drawn for a disc, as in engine/scenes/mechanism_figure.c

export interface Footfall {
  time: number;
  contact: number;
  x: number;
  z: number;
}

// Where contacts began to bear; at time 0 those that bear from the start, which fell before. `contacts` have forces, each
// row has places of `columns`.
export function footfalls(rows: Trajectory, contacts: number, columns: number): Footfall[] {
  const found: Footfall[] = [];
  for (let c = 0; c < contacts; c++) {
    let last = -Infinity;
    for (let k = 0; k < rows.time.length; k++) {
      const place = 2 * (k * columns + c);
      if (!(rows.force[place] > 0)) continue;
      const time = rows.time[k];
      if (time - last > pause) found.push({ time: k > 1 ? time : 0, contact: c, x: rows.contact[place], z: rows.contact[place + 1] });
      last = time;
    }
  }
  return found.sort((a, b) => a.time - b.time);
}

// The discs of a figure: the first of their points, with the centre before it, and their radius.
export function discs(points: [number, number][]): { at: number; radius: number }[] {
  const found: { at: number; radius: number }[] = [];
  for (let p = 0; p + sides + 2 < points.length; p++) {
    const [x, z] = points[p];
    const far = (k: number): number => Math.hypot(points[p + k][0] - x, points[p + k][1] - z);
    const radius = far(1);
    if (!(radius > 0) || far(sides + 2) > 1e-9 * radius) continue;
    let round = Math.hypot(points[p + 1][0] - points[p + sides + 1][0], points[p + 1][1] - points[p + sides + 1][1]) < 1e-9 * radius;
    for (let k = 2; k <= sides; k++) round = round && Math.abs(far(k) - radius) < 1e-9 * radius;
    if (round) found.push({ at: p + 1, radius });
  }
  return found;
}

export const discPoints = sides + 1; // the last of them is the first
