// courses.ts - time courses of the cases that are played, one under the other, with a line at the time; dragging moves it.
import uPlot from 'uplot';
import { el, style } from './dom';
import { hues } from './colours';
import { label, numberText } from './numbers';
import type { PlayedCase } from './player';

interface Group {
  name: string;
  unit(c: PlayedCase): string;
  names(c: PlayedCase): string[];
  numbers(c: PlayedCase, k: number): ArrayLike<number>;
}

const column = (rows: Float64Array, width: number, k: number): Float64Array => Float64Array.from({ length: rows.length / width }, (_, i) => rows[i * width + k]);
const units = (list: { unit: string }[]): string => [...new Set(list.map((x) => x.unit))].join(', ');

const groups: Group[] = [
  { name: 'coordinates', unit: (c) => units(c.scene.coordinates), names: (c) => c.scene.coordinates.map((x) => x.name), numbers: (c, k) => column(c.rows.position, c.scene.coordinates.length, k) },
  { name: 'rates', unit: (c) => units(c.scene.coordinates.map((x) => ({ unit: `${x.unit}/s` }))), names: (c) => c.scene.coordinates.map((x) => `v${x.name}`), numbers: (c, k) => column(c.rows.velocity, c.scene.coordinates.length, k) },
  { name: 'torques', unit: (c) => units(c.scene.actuators), names: (c) => c.scene.actuators.map((x) => x.name), numbers: (c, k) => column(c.rows.torque, c.scene.actuators.length, k) },
  {
    name: 'forces', unit: () => 'N', names: (c) => c.scene.contacts.flatMap((x) => [`${x} normal`, `${x} tangential`]),
    numbers: (c, k) => column(c.rows.force, 2 * c.text.contacts, k),
  },
  { name: 'gaps', unit: () => 'm', names: (c) => c.scene.contacts, numbers: (c, k) => column(c.rows.gap, c.text.contacts, k) },
  { name: 'energy', unit: () => 'J', names: () => ['energy'], numbers: (c) => c.rows.energy },
];

// Blows last a row, and make all else flat: the range of the other forces where blows are many times as large, else null.
function withoutBlows(tables: uPlot.AlignedData[]): [number, number] | null {
  const all = tables.flatMap((t) => t.slice(1).flatMap((y) => (y as (number | null)[]).filter((x) => x !== null))).sort((a, b) => a - b);
  if (all.length < 100) return null;
  const [low, high] = [0.01, 0.99].map((share) => all[Math.round(share * (all.length - 1))]);
  const span = high - low;
  return span > 0 && all[all.length - 1] - all[0] > 3 * span ? [low - 0.1 * span, high + 0.1 * span] : null;
}

export class Courses {
  private cases: PlayedCase[] = [];
  private chosen = new Set(['coordinates', 'torques', 'forces']);
  private plots: uPlot[] = [];
  private time = 0;
  private readonly bar = el('div', { class: 'group', role: 'group', 'aria-label': 'Time courses' });
  private readonly list = el('div', {});
  readonly element = el('div', { class: 'courses' }, this.bar, this.list);

  constructor(private readonly go: (time: number) => void) {
    new ResizeObserver(() => {
      for (const p of this.plots) if (this.list.clientWidth > 0 && p.width !== this.list.clientWidth) p.setSize({ width: this.list.clientWidth, height: p.height });
    }).observe(this.list);
  }

  show(cases: PlayedCase[]): void {
    this.cases = cases;
    const offered = groups.filter((g) => cases.some((c) => g.names(c).length > 0));
    this.bar.replaceChildren(
      ...offered.map((g) => el('button', {
        type: 'button', class: 'small', 'aria-pressed': String(this.chosen.has(g.name)),
        onclick: (e: Event) => {
          if (!this.chosen.delete(g.name)) this.chosen.add(g.name);
          (e.currentTarget as HTMLElement).setAttribute('aria-pressed', String(this.chosen.has(g.name)));
          this.draw();
        },
      }, g.name)),
    );
    this.draw();
  }

  // Of the colours of the page, too: when they change.
  draw(): void {
    for (const p of this.plots) p.destroy();
    this.plots = [];
    this.list.replaceChildren();
    for (const g of groups) if (this.chosen.has(g.name) && this.cases.some((c) => g.names(c).length > 0)) this.plot(g);
    this.at(this.time);
  }

  private plot(g: Group): void {
    const ink = style('--ink');
    const lines = { stroke: style('--line'), width: 1 };
    const names = [...new Set(this.cases.flatMap((c) => g.names(c)))];
    const series: uPlot.Series[] = [{ label: 'time (s)', value: (_, x) => (x === null ? '' : x.toFixed(3)) }];
    const tables: uPlot.AlignedData[] = this.cases.map((c, n) => {
      const own = g.names(c);
      for (const name of own)
        series.push({
          label: this.cases.length > 1 ? `${n + 1} ${name}` : name, stroke: hues[names.indexOf(name) % hues.length], width: n ? 1.2 : 1.8,
          dash: [[], [6, 4], [2, 3], [9, 3, 2, 3]][n % 4], points: { show: false }, pxAlign: 0, value: (_, y) => (y === null || y === undefined ? '' : numberText(y, 5)),
        });
      // NaN is a gap.
      const numbers = own.map((_, k) => Array.from(g.numbers(c, k), (y) => (Number.isFinite(y) ? y : null)));
      return [Array.from(c.rows.time), ...numbers] as uPlot.AlignedData;
    });
    const range = g.name === 'forces' ? withoutBlows(tables) : null;
    const box = el('div', { class: 'course', 'data-course': g.name }, el('h3', {}, `${label(g.name, g.unit(this.cases[0]))}${range ? '; blows go beyond' : ''}`));
    this.list.append(box);
    const font = '11px system-ui, sans-serif';
    const axis = { stroke: ink, grid: lines, ticks: lines, font };
    const plot = new uPlot(
      {
        width: Math.max(200, this.list.clientWidth), height: 130, series, scales: { x: { time: false }, ...(range ? { y: { range } } : {}) },
        axes: [{ ...axis, size: 26 }, { ...axis, size: 56, space: 22 }],
        cursor: { drag: { x: false, y: false }, y: false, points: { show: false }, bind: { mousemove: () => null, mouseleave: () => null, mouseenter: () => null, mousedown: () => null, mouseup: () => null, dblclick: () => null } },
        legend: { live: true },
        hooks: { ready: [(u) => u.setCursor({ left: u.valToPos(this.time, 'x'), top: 0 })] },
      },
      tables.length > 1 ? uPlot.join(tables) : tables[0],
      box,
    );
    const move = (e: PointerEvent): void => {
      if (e.buttons & 1) this.go(plot.posToVal(e.clientX - plot.over.getBoundingClientRect().left, 'x'));
    };
    plot.over.addEventListener('pointerdown', (e) => {
      plot.over.setPointerCapture(e.pointerId);
      move(e);
    });
    plot.over.addEventListener('pointermove', move);
    this.plots.push(plot);
  }

  at(time: number): void {
    this.time = time;
    for (const p of this.plots) p.setCursor({ left: p.valToPos(time, 'x'), top: 0 });
  }
}
