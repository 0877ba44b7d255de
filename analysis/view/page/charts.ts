// charts.ts - pages that are charts: curves with points and error bars, values where the pointer is.
import uPlot from 'uplot';
import { hues } from './colours';
import { el, style } from './dom';
import type { Chart, Kind } from './format';
import { label, logTics, numberText, tics } from './numbers';

const finite = (list: (number | null)[]): (number | null)[] => list.map((x) => (x !== null && Number.isFinite(x) ? x : null));

// Error bars of series k, drawn after its points.
function bars(u: uPlot, k: number, chart: Chart, colour: string): void {
  const s = chart.series[k];
  if (!s.low || !s.high) return;
  const g = u.ctx;
  g.save();
  g.strokeStyle = colour;
  g.lineWidth = window.devicePixelRatio;
  g.beginPath();
  s.x.forEach((x, i) => {
    const [low, high] = [s.low![i], s.high![i]];
    if (x === null || low === null || high === null || (chart.y.log && low <= 0)) return;
    const at = u.valToPos(x, 'x', true);
    const [a, b] = [u.valToPos(low, 'y', true), u.valToPos(high, 'y', true)];
    const half = 3 * window.devicePixelRatio;
    g.moveTo(at, a);
    g.lineTo(at, b);
    for (const y of [a, b]) {
      g.moveTo(at - half, y);
      g.lineTo(at + half, y);
    }
  });
  g.stroke();
  g.restore();
}

function one(chart: Chart, kinds: Kind[]): { element: HTMLElement; draw: () => void } {
  const box = el('div', {});
  const element = el('section', { class: 'chart', 'aria-label': chart.title }, el('h2', {}, chart.title), chart.text ? el('p', { class: 'muted' }, chart.text) : null, box);
  let plot: uPlot | null = null;
  const draw = (): void => {
    plot?.destroy();
    const ink = style('--ink');
    const grid = { stroke: style('--line'), width: 1 };
    // Of a logarithmic axis what it cannot show is left out.
    const tables = chart.series.map((s) => {
      const order = s.x.map((_, i) => i).filter((i) => s.x[i] !== null && Number.isFinite(s.x[i]) && (!chart.x.log || s.x[i]! > 0)).sort((a, b) => s.x[a]! - s.x[b]!);
      const ys = finite(order.map((i) => s.y[i])).map((y) => (chart.y.log && y !== null && y <= 0 ? null : y));
      return [order.map((i) => s.x[i]), ys] as unknown as uPlot.AlignedData;
    });
    const say = (x: number | null | undefined): string => (x === null || x === undefined ? '' : numberText(x, 5));
    const values = (_: uPlot, list: (number | null)[]): string[] => list.map(say);
    const colours = chart.series.map((s, k) => kinds.find((kind) => kind.name === s.name)?.colour ?? hues[k % hues.length]);
    const splits = (log: boolean, n: number) => (_: uPlot, _k: number, low: number, high: number): number[] => (log ? logTics : tics)(low, high, n);
    const { words } = chart.x;
    const width = Math.max(260, element.clientWidth);
    const longest = Math.max(0, ...(words ?? []).map((w) => w.length));
    const upright = !words || (longest + 2) * 7 * words.length < width - 80;
    // Names that would touch stand obliquely.
    const named: Partial<uPlot.Axis> = words
      ? { splits: () => words.map((_, k) => k), values: () => words, ...(upright ? {} : { rotate: -40, size: Math.min(190, 24 + 4.4 * longest) }) }
      : { values, splits: splits(chart.x.log, width / 90) };
    const font = '12px system-ui, sans-serif';
    const common = { stroke: ink, grid, ticks: grid, font, labelFont: font };
    const name = (x: number | null | undefined): string => (words && x !== null && x !== undefined ? (words[x] ?? '') : say(x));
    plot = new uPlot(
      {
        padding: upright ? undefined : [null, 3.6 * longest, null, null],
        width, height: (upright ? 0 : Math.min(150, 4.4 * longest)) + Math.min(420, Math.max(260, 0.5 * element.clientWidth)),
        scales: { x: { time: false, distr: chart.x.log ? 3 : 1, ...(words ? { range: [-0.5, words.length - 0.5] as [number, number] } : {}) }, y: { distr: chart.y.log ? 3 : 1, range: chart.y.log ? undefined : chartRange(chart) } },
        axes: [{ label: label(chart.x.label, chart.x.unit), ...common, ...named }, { label: label(chart.y.label, chart.y.unit), ...common, values, splits: splits(chart.y.log, 8), size: 64 }],
        series: [
          { label: label(chart.x.label, chart.x.unit), value: (_, x) => name(x) },
          ...chart.series.map((s, k): uPlot.Series => ({ label: s.name, stroke: colours[k], width: s.lines ? 1.8 : 0, paths: s.lines ? undefined : () => null, points: { show: true, size: 6 }, value: (_, y) => say(y) })),
        ],
        hooks: { drawSeries: [(u, k) => k > 0 && bars(u, k - 1, chart, colours[k - 1])] },
      },
      tables.length > 1 ? uPlot.join(tables) : tables[0],
      box,
    );
  };
  return { element, draw };
}

// With room for error bars.
function chartRange(chart: Chart): uPlot.Range.MinMax {
  const all = chart.series.flatMap((s) => [...s.y, ...(s.low ?? []), ...(s.high ?? [])]).filter((y): y is number => y !== null && Number.isFinite(y));
  const [low, high] = all.reduce(([a, b], y) => [Math.min(a, y), Math.max(b, y)], [Infinity, -Infinity]);
  const margin = 0.05 * (high - low) || 0.5;
  return all.length ? [low - margin, high + margin] : [0, 1];
}

// The page of charts; the function draws them anew, for a new size or other colours.
export function chartsPage(part: HTMLElement, charts: Chart[], kinds: Kind[]): () => void {
  const list = charts.map((c) => one(c, kinds));
  part.replaceChildren(...list.map((c) => c.element));
  return () => list.forEach((c) => c.draw());
}
