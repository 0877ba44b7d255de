// request.ts - what a map that is to be computed is made of: the view that the engine opens, and the places of its cases.
import type { Data } from './data';
import type { Answer, ViewText } from './format';
import { Computed, gridPlaces, type Get, type Layer } from './layers';
import { spacing, valueAt } from './numbers';
import type { Scale } from './scales';
import type { MapRequest, View } from './state';

// A word in a list or mapping on one line; brackets, commas and the like stand in quotes.
const yamlWord = (word: string): string => (/^[\w.+-]+$/.test(word) ? word : `'${word.replace(/'/g, "''")}'`);

// A value of a path as a scenario has it: words stand for numbers.
function said(base: ViewText, path: string, x: number): number | string {
  const f = base.fields.find((one) => one.path === path);
  return (f?.type === 'word' ? f.words?.[x] : Number.isFinite(x) ? null : f?.words?.[0]) ?? x;
}

interface Edge {
  yaml: string; // of the sweep's grid
  count: number;
  from: number; // places of the first and the last
  to: number;
}

// Values of an axis, exact ones, at a place of its own.
async function exact(data: Data, k: number, paths: number): Promise<(place: number, path: number) => number> {
  const block = await data.block(`axis-${k}`);
  return (place, path) => block[place * paths + path];
}

async function edgeOf(data: Data, base: ViewText, scale: Scale, cells: number, from: number, to: number): Promise<Edge> {
  const axis = data.axes[scale.axis];
  const { paths } = base.axes[scale.axis];
  const at = await exact(data, scale.axis, paths.length);
  const names = paths.length > 1 ? `paths: [${paths.map(yamlWord).join(', ')}]` : `path: ${yamlWord(paths[0])}`;
  const listed = (numbers: (number | string)[]): string => (paths.length > 1 ? `[${numbers.join(', ')}]` : String(numbers[0]));
  const values = (j: number): Float64Array => Float64Array.from({ length: axis.count }, (_, i) => at(i, j));
  // Only the values that the file has: words, whole numbers, uneven ones, and those for which it holds designs.
  const fields = base.fields.filter((f) => paths.includes(f.path));
  if (fields.some((f) => f.type === 'integer' || (base.designed && f.design)) || paths.some((_, j) => spacing(values(j), axis.words !== null) !== axis.spacing) || axis.spacing === 'list') {
    const first = Math.max(0, Math.round(from));
    const last = Math.min(axis.count - 1, Math.round(to));
    const listing = Array.from({ length: last - first + 1 }, (_, i) =>
      listed(paths.map((path, j) => yamlWord(String(said(base, path, at(first + i, j)))))));
    return { yaml: `{${names}, values: [${listing.join(', ')}]}`, count: listing.length, from: first, to: last };
  }
  const end = (p: number): string =>
    listed(paths.map((_, j) => valueAt(values(j), axis.spacing, p)));
  const ratios = axis.spacing === 'log' ? ', spacing: log' : '';
  return { yaml: `{${names}, from: ${end(from)}, to: ${end(to)}, count: ${cells}${ratios}}`, count: cells, from, to };
}

// Values of the axes that the map does not show, as settings.
async function fixed(data: Data, base: ViewText, shown: number[], at: number[]): Promise<View> {
  const sets: View = [];
  for (const [k, { paths }] of base.axes.entries()) {
    if (shown.includes(k)) continue;
    const value = await exact(data, k, paths.length);
    for (const [j, path] of paths.entries()) {
      sets.push(`${path}=${said(base, path, value(at[k], j))}`);
    }
  }
  return sets;
}

// The layer to be computed, empty. Where the file's own places will do, its cases keep their numbers.
export async function requestLayer(
  data: Data, base: ViewText, columns: Answer[], like: Layer, x: Scale, y: Scale | null, at: number[], changes: View, request: MapRequest,
): Promise<Computed> {
  const own = request.cells === 0 && !request.window;
  if (own || !like.grid) return new Computed(changes, like.count, columns, like.grid, like.index, like.of, like);
  const cells = request.cells || 128;
  const [x0, x1, y0, y1] = request.window ?? [-Infinity, Infinity, -Infinity, Infinity];
  const clip = (p: number, s: Scale): number => Math.max(0, Math.min(s.count - 1, p));
  const across = await edgeOf(data, base, x, cells, clip(x0, x), clip(x1, x));
  const up = y ? await edgeOf(data, base, y, cells, clip(y0, y), clip(y1, y)) : null;
  const others = await fixed(data, base, [x.axis, ...(y ? [y.axis] : [])], at);
  const sweep = `sweep={grid: [${across.yaml}${up ? `, ${up.yaml}` : ''}]}`;
  const [nx, ny] = [across.count, up?.count ?? 1];
  const grid = { nx, ny, x0: across.from, x1: across.to, y0: up?.from ?? 0, y1: up?.to ?? 0 };
  const index: Get = (n) => (n % nx) * ny + Math.floor(n / nx);
  const of: Get = (i) => (i < nx * ny ? (i % ny) * nx + Math.floor(i / ny) : -1);
  const record = data.head.wire!.includes('5:cases') ? ['record.cases=none'] : []; // numbers of cases of the file
  return new Computed([...changes, ...others, ...record, sweep], nx * ny, columns, grid, index, of, gridPlaces(grid));
}
