// scales.ts - what a map can have along an edge: an axis of the file, or a path that a sample varies. Places p run along
// it: 0, 1, ... at the values of an axis; at the values themselves (their logarithms) of a sample's path.
import type { Axis, Data } from './data';
import { label, logTics, numberText, placeOf, tics, ticTexts, valueAt, withUnit, type Spacing } from './numbers';

export interface Tic {
  p: number;
  text: string;
}

export interface Scale {
  path: string;
  text: string; // long name
  unit: string;
  axis: number; // of the file; the sample's for a path that it varies
  varied: number; // which path of the sample, or -1
  count: number; // cells
  from: number; // places that the edges of a map show
  to: number;
  spacing: Spacing;
  values: number[];
  value(p: number): number;
  place(x: number): number;
  say(p: number): string; // value with its unit
  tics(from: number, to: number, n: number): Tic[];
  label: string;
}

const numberTics = (list: number[], place: (x: number) => number): Tic[] => {
  const texts = ticTexts(list);
  return list.map((x, k) => ({ p: place(x), text: texts[k] }));
};

// Least width of a window, in places.
export const leastWidth = (s: Scale): number => (s.varied < 0 ? 1e-3 : (s.to - s.from) * 1e-6);

export function listTics(values: number[], words: string[] | null, from: number, to: number, n: number): Tic[] {
  const first = Math.max(0, Math.ceil(from));
  const last = Math.min(values.length - 1, Math.floor(to));
  const every = Math.max(1, Math.ceil((last - first + 1) / Math.max(1, n)));
  const found: Tic[] = [];
  for (let p = first; p <= last; p += every) found.push({ p, text: words ? words[values[p]] : numberText(values[p], 4) });
  return found;
}

function ofAxis(a: Axis, k: number): Scale {
  const value = (p: number): number => valueAt(a.values, a.spacing, p);
  const place = (x: number): number => placeOf(a.values, a.spacing, x);
  return {
    path: a.path, text: a.text, unit: a.unit, axis: k, varied: -1, count: a.count, from: -0.5, to: a.count - 0.5,
    spacing: a.spacing, values: a.values, value, place,
    say: (p) => (a.words ? a.words[a.values[Math.round(p)]] : withUnit(numberText(value(p)), a.unit)),
    tics: (from, to, n) => {
      if (a.spacing === 'list') return listTics(a.values, a.words, from, to, n);
      const ends = [value(from), value(to)].sort((x, y) => x - y);
      const list = a.spacing === 'log' ? logTics(ends[0], ends[1], n) : tics(ends[0], ends[1], n);
      return numberTics(list, place);
    },
    label: label(a.path, a.unit),
  };
}

function ofVaried(data: Data, k: number): Scale {
  const v = data.head.varied[k];
  const finite = v.values.filter(Number.isFinite);
  let low = Infinity;
  let high = -Infinity;
  for (const x of finite) {
    low = Math.min(low, x);
    high = Math.max(high, x);
  }
  if (!(high >= low)) [low, high] = [0, 1];
  const log = v.words === null && low > 0 && high / low > 8;
  const value = (p: number): number => (log ? 10 ** p : p);
  const place = (x: number): number => (log ? Math.log10(x) : x);
  const margin = 0.03 * (place(high) - place(low)) || 0.5;
  return {
    path: v.path, text: v.text, unit: v.unit, axis: data.head.sample, varied: k, count: v.values.length,
    from: place(low) - margin, to: place(high) + margin, spacing: log ? 'log' : 'linear', values: v.values, value, place,
    say: (p) => (v.words ? v.words[Math.round(p)] : withUnit(numberText(value(p)), v.unit)),
    tics: (from, to, n) =>
      v.words
        ? v.words.map((text, p) => ({ p, text })).filter((t) => t.p >= from && t.p <= to)
        : numberTics(log ? logTics(value(from), value(to), n) : tics(from, to, n), place),
    label: label(v.path, v.unit),
  };
}

// All that a map may have along its edges; a sample itself is no scale, its paths are.
export function scalesOf(data: Data): Scale[] {
  const axes = data.axes.map(ofAxis).filter((s) => s.axis !== data.head.sample && s.count > 1);
  return axes.concat(data.head.varied.map((_, k) => ofVaried(data, k)));
}

// A scale of numbers for curves.
export function numberScale(low: number, high: number, name: string, unit: string): Scale {
  if (!(high > low)) [low, high] = [low - 0.5, low + 0.5];
  const margin = 0.04 * (high - low);
  return {
    path: name, text: name, unit, axis: -1, varied: -1, count: 2, from: low - margin, to: high + margin, spacing: 'linear',
    values: [low, high], value: (p) => p, place: (x) => x, say: (p) => withUnit(numberText(p), unit),
    tics: (from, to, n) => numberTics(tics(from, to, n), (x) => x), label: label(name, unit),
  };
}

