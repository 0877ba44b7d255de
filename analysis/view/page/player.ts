// player.ts - cases as stick figures that move, one over the other or side by side, with contact forces as arrows and
// torques as arcs, to scale; the ground; and what moves the time.
import { hues } from './colours';
import { context, eachFrame, el, style } from './dom';
import type { PlayText, Trajectory, ViewText } from './format';
import { discPoints, discs, footfalls, type Footfall } from './gait';
import { height, meanHeight, plates } from './ground';
import { numberText } from './numbers';

export interface PlayedCase {
  name: string;
  outcome: string;
  hue: string;
  text: PlayText;
  rows: Trajectory;
  scene: ViewText;
  values: Record<string, number | string | null>;
}

interface Box {
  left: number;
  right: number;
  low: number;
  high: number;
}

const speeds: [string, number][] = [['1\u00d7', 1], ['1/2', 0.5], ['1/5', 0.2], ['1/10', 0.1], ['1/20', 0.05], ['1/50', 0.02]];
const torque_colour = '#009e73';

// Row of a trajectory at a time: the last one that is not later.
export function rowAt(rows: Trajectory, time: number): number {
  const { time: t } = rows;
  let low = 0;
  let high = t.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}

const roundDown = (x: number): number => {
  const power = 10 ** Math.floor(Math.log10(x));
  return (x / power >= 5 ? 5 : x / power >= 2 ? 2 : 1) * power;
};

const roundUp = (x: number): number => {
  const power = 10 ** Math.floor(Math.log10(x));
  return (x / power > 5 ? 10 : x / power > 2 ? 5 : x / power > 1 ? 2 : 1) * power;
};

export class Player {
  private cases: PlayedCase[] = [];
  private beside = false;
  private time = 0;
  private playing = false;
  private last = 0;
  private readonly canvas = el('canvas', { id: 'figure', role: 'img', tabindex: '0' });
  private readonly button = el('button', { type: 'button', id: 'play', onclick: () => this.play(!this.playing) }, 'play');
  private readonly scrub = el('input', { type: 'range', id: 'scrub', min: 0, step: 'any', 'aria-label': 'Time', oninput: () => this.go(Number(this.scrub.value)) });
  private readonly clock = el('output', { id: 'clock' });
  private readonly speed = el('select', { 'aria-label': 'Speed' }, ...speeds.map(([text, x]) => el('option', { value: x }, text)));
  private redraw = eachFrame(() => this.draw());
  // Of all cases and rows: what is in sight, and the largest force and torque.
  private box: Box = { left: 0, right: 1, low: 0, high: 1 };
  private follows = false;
  private size = 1; // of the figures, m
  private steps = new Map<PlayedCase, Footfall[]>(); // of robots that go away, and of walkers
  private force = 0;
  private torque = 0;
  readonly element: HTMLElement;

  constructor(private readonly moved: (time: number, passing: boolean) => void) {
    const step = (by: number, text: string, name: string): HTMLElement =>
      el('button', { type: 'button', 'aria-label': name, onclick: () => this.step(by) }, text);
    this.element = el('div', { class: 'player' }, this.canvas,
      el('div', { class: 'transport', role: 'group', 'aria-label': 'Playing' }, this.button, step(-1, '\u2039', 'One step back'), step(1, '\u203a', 'One step on'), this.speed, this.scrub, this.clock));
    new ResizeObserver(() => this.redraw()).observe(this.canvas);
  }

  show(cases: PlayedCase[], beside: boolean): void {
    this.cases = cases;
    this.beside = beside && cases.length > 1;
    this.measure();
    this.scrub.max = String(this.end());
    if (!cases.length) this.play(false);
    this.redraw();
  }

  private end = (): number => Math.max(0, ...this.cases.map((c) => c.rows.time[c.rows.time.length - 1]));

  play(on: boolean): void {
    if (on && this.time >= this.end() - 1e-9) this.at(0);
    if (on && !this.playing) {
      this.last = performance.now();
      requestAnimationFrame((now) => this.frame(now));
    }
    this.playing = on && this.cases.length > 0;
    this.button.textContent = this.playing ? 'pause' : 'play';
    this.button.setAttribute('aria-pressed', String(this.playing));
    if (!this.playing) this.moved(this.time, false);
  }

  private frame(now: number): void {
    if (!this.playing) return;
    const next = this.time + ((now - this.last) / 1000) * Number(this.speed.value);
    this.last = now;
    this.at(Math.min(next, this.end()));
    this.moved(this.time, true);
    if (this.time >= this.end()) this.play(false);
    else requestAnimationFrame((t) => this.frame(t));
  }

  // Time from outside; nobody is told.
  at(time: number): void {
    this.time = time;
    this.scrub.value = String(time);
    const text = `${time.toFixed(3)} / ${numberText(this.end(), 4)} s`;
    this.clock.textContent = text;
    this.scrub.setAttribute('aria-valuetext', text);
    this.redraw();
  }

  go(time: number): void {
    this.at(Math.max(0, Math.min(this.end(), time)));
    this.moved(this.time, true);
  }

  step(by: number): void {
    if (this.playing) this.play(false);
    // Of the case that lasts longest.
    const end = this.end();
    const rows = this.cases.find((c) => c.rows.time[c.rows.time.length - 1] === end)?.rows;
    if (rows) this.go(rows.time[Math.max(0, Math.min(rows.time.length - 1, rowAt(rows, this.time) + by))]);
  }

  // Keys of the page: true if this was one of the player's.
  key(key: string): boolean {
    if (!this.cases.length || ![' ', ',', '.'].includes(key)) return false;
    if (key === ' ') this.play(!this.playing);
    else this.step(key === '.' ? 1 : -1);
    return true;
  }

  // ---- geometry ----
  // Frames in which the ground is level and gravity leans are turned so that gravity points down.
  private lean = (c: PlayedCase): number => (c.text.slope === 0 && c.scene.scene !== 'mechanism' ? Number(c.values['robot.slope'] ?? 0) : 0);
  private fall = (c: PlayedCase): number => c.text.slope + this.lean(c);
  private turned(c: PlayedCase, x: number, z: number): [number, number] {
    const a = this.lean(c);
    return a === 0 ? [x, z] : [x * Math.cos(a) + z * Math.sin(a), -x * Math.sin(a) + z * Math.cos(a)];
  }

  private measure(): void {
    const box: Box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
    const over = { low: Infinity, high: -Infinity }; // heights over the ground
    const forces: number[] = [];
    this.torque = 0;
    let size = 0;
    const grounds: number[] = []; // plates' heights, under the figures
    for (const c of this.cases) {
      const { figure, force, torque } = c.rows;
      const points = c.text.figure;
      const first: Box = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
      for (let p = 0; 2 * p < figure.length; p++) {
        const [x, z] = this.turned(c, figure[2 * p], figure[2 * p + 1]);
        if (!Number.isFinite(x) || Math.abs(x) + Math.abs(z) > 1e4) continue;
        for (const b of p < points ? [box, first] : [box]) {
          b.left = Math.min(b.left, x);
          b.right = Math.max(b.right, x);
          b.low = Math.min(b.low, z);
          b.high = Math.max(b.high, z);
        }
      }
      size = this.size = Math.max(size, first.right - first.left, first.high - first.low);
      for (let k = 0; k < c.rows.time.length; k++) {
        const { base } = this.under(c, k);
        for (let p = k * points; p < (k + 1) * points; p++) {
          const [x, z] = this.turned(c, figure[2 * p], figure[2 * p + 1]);
          if (!Number.isFinite(x) || Math.abs(x) + Math.abs(z) > 1e4) continue;
          // On even ground over it where the point is.
          const above = z - base - (c.text.ground.length ? 0 : this.height(c, x) - base);
          over.low = Math.min(over.low, above);
          over.high = Math.max(over.high, above);
        }
      }
      for (const { points: line } of c.text.ground)
        for (let i = 0; i < line.length; i += 2) if (line[i] >= box.left && line[i] <= box.right) grounds.push(line[i + 1]);
      for (let k = 0; k < force.length; k += 2) if (force[k] > 0) forces.push(Math.hypot(force[k], force[k + 1]));
      for (const t of torque) if (Number.isFinite(t)) this.torque = Math.max(this.torque, Math.abs(t));
    }
    if (!(box.right >= box.left)) Object.assign(box, { left: -0.5, right: 0.5, low: 0, high: 1 });
    size = this.size = size || 1;
    forces.sort((a, b) => a - b);
    // Blows aside: the force that one row in fifty exceeds.
    this.force = forces.length ? forces[Math.floor(0.98 * (forces.length - 1))] : 0;
    this.follows = box.right - box.left > 3.2 * size;
    if (this.follows) Object.assign(box, { left: -size, right: size }, over);
    this.steps = new Map(this.follows || this.cases.some((c) => c.values['ground.lands'] === 'ahead') ? this.cases.map((c) => [c, footfalls(c.rows, c.scene.contacts.length, c.text.contacts)]) : []);
    const margin = 0.16 * size;
    this.box = { left: box.left - margin, right: box.right + margin, low: Math.min(box.low, this.follows ? 0 : Math.min(0, ...grounds)) - margin, high: box.high + margin };
  }

  // ---- drawing ----
  private draw(): void {
    const { g, width, height } = context(this.canvas);
    const panels = this.beside ? this.cases.length : 1;
    const across = width > 460 || panels < 2 ? panels : Math.ceil(panels / 2);
    const down = Math.ceil(panels / across);
    for (let k = 0; k < panels; k++) {
      const [w, h] = [width / across, height / down];
      g.save();
      g.beginPath();
      g.rect((k % across) * w, Math.floor(k / across) * h, w, h);
      g.clip();
      g.translate((k % across) * w, Math.floor(k / across) * h);
      this.panel(g, w, h, this.beside ? [this.cases[k]] : this.cases);
      g.restore();
    }
    this.canvas.setAttribute('aria-label', this.describe());
  }

  private describe(): string {
    return this.cases.map((c) => {
      const k = rowAt(c.rows, this.time);
      const q = c.scene.coordinates.map((x, i) => `${x.name} ${numberText(c.rows.position[k * c.scene.coordinates.length + i], 3)} ${x.unit}`);
      const steps = this.steps.size ? `, ${this.fallen(c).filter((x) => x.time > 0).length} footfalls` : '';
      return `${c.name}, ${c.outcome}, at ${this.time.toFixed(3)} s: ${q.join(', ')}${steps}`;
    }).join('; ');
  }

  private panel(g: CanvasRenderingContext2D, width: number, height: number, cases: PlayedCase[]): void {
    const [first] = cases;
    if (!first) return;
    const { box } = this;
    const scale = Math.min(width / (box.right - box.left), (height - 22) / (box.high - box.low));
    const { middle, base } = this.centre(first);
    const X = (x: number): number => width / 2 + (x - middle - (box.left + box.right) / 2) * scale;
    const Y = (z: number): number => height - 4 - (z - base - box.low) * scale;
    this.ground(g, width, X, Y, first, scale);
    this.footprints(g, first, X, Y);
    [...cases].reverse().forEach((c) => this.figure(g, c, X, Y, scale, c === first));
    this.legend(g, scale, cases);
  }

  // Where the view is that moves with the first case.
  private centre(c: PlayedCase): { middle: number; base: number } {
    return this.follows ? this.under(c, rowAt(c.rows, this.time)) : { middle: 0, base: 0 };
  }

  // The middle of the figure in a row, and the ground there.
  private under(c: PlayedCase, k: number): { middle: number; base: number } {
    const n = c.text.figure;
    let sum = 0;
    let count = 0;
    for (let p = 0; p < n; p++) {
      const [x] = this.turned(c, c.rows.figure[2 * (k * n + p)], c.rows.figure[2 * (k * n + p) + 1]);
      if (Number.isFinite(x)) [sum, count] = [sum + x, count + 1];
    }
    const middle = count ? sum / count : 0;
    const line = plates(c.text, c.rows.time[k]);
    return { middle, base: line ? meanHeight(line, middle, this.size / 2) : this.height(c, middle) };
  }

  // Of the ground at x, now.
  private height(c: PlayedCase, x: number): number {
    const line = plates(c.text, this.time);
    return line ? height(line, x) : -Math.tan(this.fall(c)) * x;
  }

  private ground(g: CanvasRenderingContext2D, width: number, X: (x: number) => number, Y: (z: number) => number, c: PlayedCase, scale: number): void {
    const left = (0 - X(0)) / scale;
    const right = (width - X(0)) / scale;
    const z = (x: number): number => this.height(c, x);
    const line = plates(c.text, this.time) ?? [];
    g.strokeStyle = style('--ground');
    g.lineWidth = 1.5;
    g.beginPath();
    g.moveTo(0, Y(z(left)));
    for (let i = 0; i < line.length; i += 2) if (line[i] > left && line[i] < right) g.lineTo(X(line[i]), Y(line[i + 1]));
    g.lineTo(width, Y(z(right)));
    g.stroke();
    g.lineWidth = 0.7;
    g.beginPath();
    const step = roundDown(40 / scale);
    for (let x = Math.floor(left / step) * step; x < right; x += step) {
      g.moveTo(X(x), Y(z(x)));
      g.lineTo(X(x) - 7, Y(z(x)) + 9);
    }
    g.stroke();
    if (!this.steps.size) return;
    // How far it has gone.
    g.fillStyle = style('--muted');
    g.font = '10px system-ui, sans-serif';
    g.textBaseline = 'top';
    g.textAlign = 'center';
    const metres = roundUp(70 / scale);
    for (let x = Math.ceil(left / metres) * metres; x < right; x += metres) g.fillText(`${numberText(x, 4)} m`, X(x), Y(z(x)) + 13);
  }

  private fallen = (c: PlayedCase): Footfall[] => (this.steps.get(c) ?? []).filter((x) => x.time <= this.time + 1e-9);

  // Where feet have come down until now, in their colours.
  private footprints(g: CanvasRenderingContext2D, c: PlayedCase, X: (x: number) => number, Y: (z: number) => number): void {
    for (const step of this.fallen(c)) {
      const [x, z] = this.turned(c, step.x, step.z);
      g.fillStyle = hues[step.contact % hues.length];
      g.beginPath();
      g.moveTo(X(x), Y(z));
      g.lineTo(X(x) - 5, Y(z) + 9);
      g.lineTo(X(x) + 5, Y(z) + 9);
      g.fill();
    }
  }

  private figure(g: CanvasRenderingContext2D, c: PlayedCase, X: (x: number) => number, Y: (z: number) => number, scale: number, solid: boolean): void {
    const { rows, text } = c;
    const k = rowAt(rows, this.time);
    const n = text.figure;
    // Between two rows where the points are, in proportion.
    const next = Math.min(k + 1, rows.time.length - 1);
    const share = next > k ? Math.min(1, Math.max(0, (this.time - rows.time[k]) / (rows.time[next] - rows.time[k]))) : 0;
    const there = (row: number, list: Float64Array, per: number, i: number): [number, number] => this.turned(c, list[(row * per + i) * 2], list[(row * per + i) * 2 + 1]);
    const between = (list: Float64Array, per: number, i: number): [number, number] => {
      const [[x, z], [x1, z1]] = [there(k, list, per, i), there(next, list, per, i)];
      return [x + share * (x1 - x), z + share * (z1 - z)];
    };
    g.globalAlpha = solid ? 1 : 0.45;
    g.lineWidth = solid ? 4 : 3;
    g.lineJoin = g.lineCap = 'round';
    const points = Array.from({ length: n }, (_, p) => between(rows.figure, n, p));
    const body = this.cases.length > 1 ? c.hue : style('--figure');
    const ink = (contact: number): string => (this.cases.length > 1 || contact < 0 ? body : hues[contact % hues.length]);
    // What ends at one contact, or at the centre of its disc, has its colour; so has the disc. An outline, which ends where
    // it begins and nowhere turns back as a line through links does, is the body. Told in the row, where distances are exact.
    const own = Array.from({ length: n }, (_, p) => there(k, rows.figure, n, p));
    const contacts = c.scene.contacts.map((_, i) => there(k, rows.contact, text.contacts, i));
    const distance = (a: [number, number], b: [number, number]): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
    const touches = (p: [number, number], radius: number): number => contacts.findIndex((q) => Math.abs(distance(p, q) - radius) < 1e-9);
    const round = discs(own);
    const closed = n > 1 && distance(own[0], own[n - 1]) < 1e-9;
    const outline = closed && (round.length > 0 ? contacts.length < 2 : !own.some((p, i) => i > 1 && distance(p, own[i - 2]) < 1e-9));
    const of = own.map((p) => touches(p, 0));
    const drawn = new Set<number>(); // points that a circle takes the place of, with the lines from there on
    for (const { at, radius } of round) {
      const contact = outline ? -1 : touches(own[at - 1], radius);
      of[at - 1] = of[at + discPoints] = contact;
      for (let p = at; p < at + discPoints - 1; p++) drawn.add(p);
      g.strokeStyle = ink(contact);
      g.beginPath();
      g.arc(X(points[at - 1][0]), Y(points[at - 1][1]), radius * scale, 0, 7);
      g.stroke();
    }
    for (let p = 0; p + 1 < n; p++) {
      const [[a, b], [x, z]] = [points[p], points[p + 1]];
      if (!Number.isFinite(a + b + x + z) || drawn.has(p)) continue;
      const leg = outline || (of[p] >= 0) === (of[p + 1] >= 0) ? -1 : Math.max(of[p], of[p + 1]);
      g.strokeStyle = ink(leg);
      g.beginPath();
      g.moveTo(X(a), Y(b));
      g.lineTo(X(x), Y(z));
      g.stroke();
    }
    points.forEach(([x, z], p) => {
      if (outline || drawn.has(p) || drawn.has(p - 1) || !Number.isFinite(x + z)) return;
      g.fillStyle = ink(of[p]);
      g.beginPath();
      g.arc(X(x), Y(z), 3.6, 0, 7);
      g.fill();
    });
    if (solid) {
      this.forces(g, c, next, between, X, Y, scale);
      this.torques(g, c, next, X, Y);
    }
    g.globalAlpha = 1;
  }

  // Of the row that the time is in: forces are means since the row before.
  private forces(g: CanvasRenderingContext2D, c: PlayedCase, row: number, between: (l: Float64Array, per: number, i: number) => [number, number],
    X: (x: number) => number, Y: (z: number) => number, scale: number): void {
    const contacts = c.scene.contacts.length;
    const columns = c.text.contacts;
    const slope = this.fall(c);
    const factor = this.forceScale(scale);
    for (let i = 0; i < contacts && factor > 0; i++) {
      const [x, z] = between(c.rows.contact, columns, i);
      const normal = c.rows.force[2 * (row * columns + i)];
      const tangential = c.rows.force[2 * (row * columns + i) + 1];
      if (!Number.isFinite(x) || !(Math.hypot(normal, tangential) > 0)) continue;
      const dx = normal * Math.sin(slope) + tangential * Math.cos(slope);
      const dz = normal * Math.cos(slope) - tangential * Math.sin(slope);
      arrow(g, X(x), Y(z), dx * factor, -dz * factor, hues[i % hues.length]);
    }
  }

  // Pixels per newton.
  private forceScale = (scale: number): number => (this.force > 0 ? (0.32 * (this.box.high - this.box.low) * scale) / this.force : 0);
  private arc = (torque: number): number => (this.torque > 0 ? (torque / this.torque) * 1.4 * Math.PI : 0);

  private torques(g: CanvasRenderingContext2D, c: PlayedCase, row: number, X: (x: number) => number, Y: (z: number) => number): void {
    const count = c.scene.actuators.length;
    for (let a = 0; a < count; a++) {
      const torque = c.rows.torque[row * count + a];
      const [px, pz, dx, dz] = c.rows.actuator.subarray(4 * (row * count + a), 4 * (row * count + a) + 4);
      if (!Number.isFinite(torque) || torque === 0 || !Number.isFinite(px)) continue;
      const [x, z] = this.turned(c, px, pz);
      if (Number.isFinite(dx)) {
        const [ux, uz] = this.turned(c, dx, dz);
        const size = (40 * torque) / this.torque / (Math.hypot(ux, uz) || 1);
        arrow(g, X(x), Y(z), ux * size, -uz * size, torque_colour);
      } else turn(g, X(x), Y(z), 15 + 4 * (a % 2), this.arc(torque));
    }
  }

  private legend(g: CanvasRenderingContext2D, scale: number, cases: PlayedCase[]): void {
    g.font = '11px system-ui, sans-serif';
    g.textBaseline = 'middle';
    g.textAlign = 'left';
    let x = 8;
    const word = (text: string, colour: string): void => {
      g.fillStyle = colour;
      g.fillText(text, x, 12);
      x += g.measureText(text).width + 14;
    };
    if (this.beside) word(cases[0].name, cases[0].hue);
    const factor = this.forceScale(scale);
    if (factor > 0) {
      const force = roundDown(60 / factor);
      arrow(g, x, 12, force * factor, 0, style('--ink'));
      x += force * factor + 6;
      word(`${numberText(force)} N`, style('--ink'));
    }
    if (this.torque > 0) {
      const torque = roundDown(this.torque);
      turn(g, x + 9, 13, 8, this.arc(torque));
      x += 22;
      const unit = cases[0].scene.actuators[0]?.unit ?? 'N m';
      word(`${numberText(torque)} ${unit}`, style('--ink'));
    }
    const metre = roundDown(90 / scale);
    g.strokeStyle = g.fillStyle = style('--muted');
    g.lineWidth = 2;
    g.beginPath();
    g.moveTo(x, 12);
    g.lineTo(x + metre * scale, 12);
    g.stroke();
    x += metre * scale + 5;
    word(`${numberText(metre)} m`, style('--ink'));
    for (const text of this.pushes(cases[0])) word(text, style('--ink'));
  }

  // What pushes now; a blow is told for a tenth of a second.
  private pushes(c: PlayedCase): string[] {
    const number = (path: string): number => Number(c.values[path] ?? 0);
    return Object.keys(c.values).flatMap((path) => {
      const [, point, kind] = /^(robot\.points\..*)\.(force|impulse)\[0\]$/.exec(path) ?? [];
      if (!point) return [];
      const size = Math.hypot(number(path), number(`${point}.${kind}[1]`));
      const from = number(`${point}.from`);
      const to = kind === 'force' ? number(`${point}.to`) : from + 0.1;
      return size > 0 && this.time >= from && this.time < to ? [`push at ${point.slice('robot.points.'.length)}: ${numberText(size, 3)} ${kind === 'force' ? 'N' : 'N s'}`] : [];
    });
  }
}

function head(g: CanvasRenderingContext2D, x: number, y: number, angle: number, size: number): void {
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(x - size * Math.cos(angle - 0.4), y - size * Math.sin(angle - 0.4));
  g.lineTo(x - size * Math.cos(angle + 0.4), y - size * Math.sin(angle + 0.4));
  g.fill();
}

function arrow(g: CanvasRenderingContext2D, x: number, y: number, dx: number, dy: number, colour: string): void {
  const size = Math.hypot(dx, dy);
  if (size < 1) return;
  g.strokeStyle = g.fillStyle = colour;
  g.lineWidth = 2;
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(x + dx * (1 - Math.min(1, 6 / size)), y + dy * (1 - Math.min(1, 6 / size)));
  g.stroke();
  head(g, x + dx, y + dy, Math.atan2(dy, dx), Math.min(8, size));
}

// An arc of `angle`, counter-clockwise as x is to the right and z up.
function turn(g: CanvasRenderingContext2D, x: number, y: number, radius: number, angle: number): void {
  if (Math.abs(angle) < 0.02) return;
  const from = -Math.PI / 2;
  g.strokeStyle = g.fillStyle = torque_colour;
  g.lineWidth = 2.2;
  g.beginPath();
  g.arc(x, y, radius, from, from - angle, angle > 0);
  g.stroke();
  const end = from - angle;
  head(g, x + radius * Math.cos(end), y + radius * Math.sin(end), end + (angle > 0 ? -1 : 1) * (Math.PI / 2), 6);
}

export const reduced = (): boolean => window.matchMedia('(prefers-reduced-motion: reduce)').matches;
