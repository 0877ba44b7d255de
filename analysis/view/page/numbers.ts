// numbers.ts - numbers as people read them: texts, tics and scales of axes.

// A number in at most `digits` significant digits, without trailing zeros.
export function numberText(x: number | null | undefined, digits = 6): string {
  if (x === null || x === undefined || Number.isNaN(x)) return '-';
  if (!Number.isFinite(x)) return x > 0 ? 'infinite' : '-infinite';
  const text = Number(x.toPrecision(digits));
  const size = Math.abs(text);
  return size !== 0 && (size < 1e-4 || size >= 1e7)
    ? text.toExponential().replace('e+', 'e').replace('-', '\u2212').replace('e-', 'e\u2212')
    : String(text).replace('-', '\u2212');
}

export const withUnit = (x: string, unit: string): string => (unit === '' || unit === '1' ? x : `${x} ${unit}`);
export const label = (name: string, unit: string): string => (unit === '' || unit === '1' ? name : `${name} (${unit})`);

// The end of a path that tells it from others: two parts of it, `[0]` with what it is of.
export function shortPath(path: string): string {
  const parts = path.split('.');
  return parts.length > 2 ? parts.slice(parts[parts.length - 2] === 'offset' ? -1 : -2).join('.') : path;
}

// Round steps (1, 2 or 5 times a power of ten) between low and high, about n of them.
export function tics(low: number, high: number, n: number): number[] {
  if (!(high > low)) return [low];
  const rough = (high - low) / Math.max(1, n);
  const power = 10 ** Math.floor(Math.log10(rough));
  const digit = rough / power;
  const step = (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10) * power;
  const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  if (!(Math.max(-first, last) < 1e14)) return [low, high]; // no round numbers lie between
  const found = Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => Number(((first + k) * step).toPrecision(15)));
  return found.length > 1 || n > 20 ? found : tics(low, high, n + 1); // two at least
}

// Texts of tics, in as many digits as tell them apart.
export function ticTexts(list: number[]): string[] {
  const size = Math.max(...list.map(Math.abs)) / Math.abs(list[1] - list[0]);
  return list.map((x) => numberText(x, Math.max(6, Math.min(15, Math.ceil(Math.log10(size)) + 1 || 6))));
}

// Tics of a logarithmic scale.
export function logTics(low: number, high: number, n: number): number[] {
  const decades = Math.log10(high / low);
  if (decades < 0.8) return tics(low, high, n).filter((x) => x > 0);
  const digits = n >= 3 * decades ? [1, 2, 5] : n >= 2 * decades ? [1, 3] : [1];
  const every = Math.max(1, Math.ceil(decades / n));
  const found: number[] = [];
  for (let p = Math.floor(Math.log10(low)); p <= Math.ceil(Math.log10(high)); p++)
    for (const d of digits) {
      const x = d * 10 ** p;
      if (x >= low * (1 - 1e-9) && x <= high * (1 + 1e-9) && p % every === 0) found.push(Number(x.toPrecision(12)));
    }
  return found.length > 1 ? found : tics(low, high, n).filter((x) => x > 0);
}

// How the values of an axis lie: places p = 0 ... count - 1 along it, between them where that means something.
export type Spacing = 'linear' | 'log' | 'list';

export function spacing(values: ArrayLike<number>, words: boolean): Spacing {
  const n = values.length;
  if (words || n < 2) return 'list';
  const even = (f: (x: number) => number): boolean => {
    const first = f(values[0]);
    const step = (f(values[n - 1]) - first) / (n - 1);
    if (!Number.isFinite(step) || step === 0) return false;
    for (let i = 0; i < n; i++) if (Math.abs(f(values[i]) - first - i * step) > 1e-6 * Math.abs(step) * Math.max(1, n / 100)) return false;
    return true;
  };
  if (even((x) => x)) return 'linear';
  return values[0] > 0 && even(Math.log) ? 'log' : 'list';
}

// Value at a place p, between the first and the last value of an axis.
export function valueAt(values: ArrayLike<number>, kind: Spacing, p: number): number {
  const last = values.length - 1;
  const near = Math.round(p);
  if (kind === 'list' || (Math.abs(p - near) < 1e-9 && near >= 0 && near <= last)) return values[Math.min(last, Math.max(0, near))];
  const share = p / last;
  return kind === 'log' ? values[0] * (values[last] / values[0]) ** share : values[0] + (values[last] - values[0]) * share;
}

// Place of a value, the inverse.
export function placeOf(values: ArrayLike<number>, kind: Spacing, x: number): number {
  const last = values.length - 1;
  if (kind === 'log') return (last * Math.log(x / values[0])) / Math.log(values[last] / values[0]);
  if (kind === 'linear') return (last * (x - values[0])) / (values[last] - values[0]);
  let best = 0;
  for (let i = 0; i <= last; i++) if (Math.abs(values[i] - x) < Math.abs(values[best] - x)) best = i;
  return best;
}
