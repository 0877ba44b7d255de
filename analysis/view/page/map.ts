// map.ts - the map: a canvas with cells, points or a curve, its axes, and how pointers and keys move over it. Horizontal
// and vertical places are those of scales.ts.
import { context, eachFrame, style } from './dom';
import { unknown, type Layer } from './layers';
import type { Colouring } from './paint';
import { leastWidth, numberScale, type Scale, type Tic } from './scales';

export interface Shown {
  layer: Layer;
  colouring: Colouring;
}

// A case that is played.
export interface Mark {
  layer: Layer;
  n: number;
  text: string;
}

export interface MapEvents {
  hover(shown: Shown | null, n: number, x: number, y: number): void;
  pick(shown: Shown, n: number, add: boolean): void;
  zoom(window: number[] | null): void;
}

interface Place {
  shown: Shown;
  n: number;
}

const coarsest = 32; // cells that one known case may stand for while others are still computed

export class MapView {
  private shown: Shown[] = []; // the last one on top
  private x: Scale | null = null;
  private y: Scale | null = null;
  private vertical: Scale | null = null; // y, or the numbers of a curve
  private window: number[] = [0, 1, 0, 1];
  private marks: Mark[] = [];
  private cursor: Place | null = null;
  private box: number[] | null = null;
  private images = new WeakMap<Colouring, { canvas: HTMLCanvasElement; done: number }>();
  private pointers = new Map<number, PointerEvent>();
  private dragged = false;
  private redraw = eachFrame(() => this.draw());

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly events: MapEvents,
  ) {
    new ResizeObserver(() => this.draw()).observe(canvas);
    canvas.addEventListener('wheel', (e) => this.wheel(e), { passive: false });
    canvas.addEventListener('pointerdown', (e) => this.down(e));
    canvas.addEventListener('pointermove', (e) => this.move(e));
    canvas.addEventListener('pointerup', (e) => this.up(e));
    canvas.addEventListener('pointercancel', (e) => this.pointers.delete(e.pointerId));
    canvas.addEventListener('pointerleave', () => this.pointers.size || this.events.hover(null, 0, 0, 0));
    canvas.addEventListener('keydown', (e) => this.key(e));
    canvas.addEventListener('blur', () => this.redraw());
    canvas.addEventListener('focus', () => this.redraw());
    canvas.addEventListener('dblclick', () => this.events.zoom(null));
  }

  show(shown: Shown[], x: Scale, y: Scale | null, zoom: number[] | null, marks: Mark[]): void {
    if (x !== this.x || y !== this.y) this.cursor = null;
    this.shown = shown;
    this.x = x;
    this.y = y;
    this.marks = marks;
    const curve = shown.at(-1)?.colouring;
    this.vertical = y ?? (curve?.bar ? numberScale(curve.bar.low, curve.bar.high, curve.title.replace(/ \(.*/, ''), curve.bar.unit) : null);
    const all = [x.from, x.to, this.vertical?.from ?? -0.5, this.vertical?.to ?? 0.5];
    this.window = zoom ?? all;
    if (!y) this.window = [this.window[0], this.window[1], all[2], all[3]];
    if (this.cursor) this.cursor = this.at(this.cursor.shown.layer.px(this.cursor.n), this.cursor.shown.layer.py(this.cursor.n));
    this.redraw();
  }

  // ---- places and pixels ----
  private frame(): { left: number; top: number; width: number; height: number } {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const left = this.vertical ? (w < 480 ? 58 : 64) : 12;
    return { left, top: 8, width: Math.max(20, w - left - 14), height: Math.max(20, h - 8 - 46) };
  }
  private toX = (p: number): number => this.frame().left + ((p - this.window[0]) / (this.window[1] - this.window[0])) * this.frame().width;
  private toY = (p: number): number => this.frame().top + (1 - (p - this.window[2]) / (this.window[3] - this.window[2])) * this.frame().height;
  private fromX = (px: number): number => this.window[0] + ((px - this.frame().left) / this.frame().width) * (this.window[1] - this.window[0]);
  private fromY = (px: number): number => this.window[2] + (1 - (px - this.frame().top) / this.frame().height) * (this.window[3] - this.window[2]);

  // The case on top at places (x, y); of points the nearest one.
  at(x: number, y: number): Place | null {
    for (const shown of [...this.shown].reverse()) {
      const { grid } = shown.layer;
      if (!grid) {
        const n = this.nearest(shown.layer, x, y);
        if (n >= 0) return { shown, n };
        continue;
      }
      const cell = (from: number, to: number, n: number, p: number): number => (n > 1 ? Math.round(((p - from) / (to - from)) * (n - 1)) : 0);
      const i = cell(grid.x0, grid.x1, grid.nx, x);
      const j = this.y ? cell(grid.y0, grid.y1, grid.ny, y) : 0;
      if (i >= 0 && j >= 0 && i < grid.nx && j < grid.ny) return { shown, n: i + j * grid.nx };
    }
    return null;
  }

  private nearest(layer: Layer, x: number, y: number): number {
    const { width, height } = this.frame();
    const sx = width / (this.window[1] - this.window[0]);
    const sy = this.y ? height / (this.window[3] - this.window[2]) : 0;
    let best = -1;
    let least = 20 ** 2;
    for (let n = 0; n < layer.count; n++) {
      const d = ((layer.px(n) - x) * sx) ** 2 + ((layer.py(n) - y) * sy) ** 2;
      if (d < least) [least, best] = [d, n];
    }
    return best;
  }

  // ---- pointers and keys ----
  private wheel(e: WheelEvent): void {
    e.preventDefault();
    this.zoomAbout(Math.exp(0.0015 * Math.max(-300, Math.min(300, e.deltaY))), this.fromX(e.offsetX), this.fromY(e.offsetY));
  }

  zoomAbout(factor: number, x?: number, y?: number): void {
    const [x0, x1, y0, y1] = this.window;
    x ??= (x0 + x1) / 2;
    y ??= (y0 + y1) / 2;
    this.to([x + (x0 - x) * factor, x + (x1 - x) * factor, y + (y0 - y) * factor, y + (y1 - y) * factor]);
  }

  // Shows these places, no more than there are.
  private to(window: number[]): void {
    if (!this.x) return;
    const clip = (low: number, high: number, from: number, to: number, least: number): number[] => {
      const size = Math.max(Math.min(high - low, to - from), least);
      const start = Math.max(from, Math.min(low + (high - low - size) / 2, to - size));
      return [start, start + size];
    };
    const across = clip(window[0], window[1], this.x.from, this.x.to, leastWidth(this.x));
    const up = this.y ? clip(window[2], window[3], this.y.from, this.y.to, leastWidth(this.y)) : [0, 0];
    const whole = across[0] === this.x.from && across[1] === this.x.to && (!this.y || (up[0] === this.y.from && up[1] === this.y.to));
    this.events.zoom(whole ? null : [...across, ...up]);
  }

  private down(e: PointerEvent): void {
    this.canvas.focus({ preventScroll: true });
    this.pointers.set(e.pointerId, e);
    this.dragged = false;
    if (e.pointerType !== 'touch') this.canvas.setPointerCapture(e.pointerId);
  }

  private move(e: PointerEvent): void {
    const before = this.pointers.get(e.pointerId);
    if (!before) {
      this.hover(e.offsetX, e.offsetY);
      return;
    }
    const others = [...this.pointers.values()].filter((p) => p.pointerId !== e.pointerId);
    if (others.length === 1) {
      // Two fingers: the places under them stay under them.
      const o = others[0];
      const distance = (a: PointerEvent): number => Math.hypot(a.offsetX - o.offsetX, a.offsetY - o.offsetY);
      const factor = distance(before) / Math.max(20, distance(e));
      const [mx, my] = [(e.offsetX + o.offsetX) / 2, (e.offsetY + o.offsetY) / 2];
      const x = this.fromX((before.offsetX + o.offsetX) / 2);
      const y = this.fromY((before.offsetY + o.offsetY) / 2);
      const f = this.frame();
      const [w, h] = [(this.window[1] - this.window[0]) * factor, (this.window[3] - this.window[2]) * factor];
      const x0 = x - ((mx - f.left) / f.width) * w;
      const y0 = y - (1 - (my - f.top) / f.height) * h;
      this.dragged = true;
      this.pointers.set(e.pointerId, e);
      this.to([x0, x0 + w, y0, y0 + h]);
      return;
    }
    if (e.pointerType === 'touch') return;
    if (Math.hypot(e.offsetX - before.offsetX, e.offsetY - before.offsetY) > 4) this.dragged = true;
    if (!this.dragged) return;
    if (before.shiftKey || before.button === 1) {
      const dx = this.fromX(before.offsetX) - this.fromX(e.offsetX);
      const dy = this.fromY(before.offsetY) - this.fromY(e.offsetY);
      const [x0, x1, y0, y1] = this.window;
      this.pointers.set(e.pointerId, e);
      this.to([x0 + dx, x1 + dx, y0 + dy, y1 + dy]);
    } else {
      this.box = [before.offsetX, before.offsetY, e.offsetX, e.offsetY];
      this.redraw();
    }
  }

  private up(e: PointerEvent): void {
    if (!this.pointers.delete(e.pointerId)) return;
    const { box } = this;
    this.box = null;
    if (box) {
      const [xa, xb] = [this.fromX(box[0]), this.fromX(box[2])].sort((a, b) => a - b);
      const [ya, yb] = [this.fromY(box[1]), this.fromY(box[3])].sort((a, b) => a - b);
      if (Math.abs(box[0] - box[2]) > 8 && (!this.y || Math.abs(box[1] - box[3]) > 8)) this.to([xa, xb, ya, yb]);
      this.redraw();
    } else if (!this.dragged) {
      const place = this.at(this.fromX(e.offsetX), this.fromY(e.offsetY));
      if (!place) return;
      this.cursor = place;
      this.events.pick(place.shown, place.n, e.shiftKey);
    }
  }

  private hover(px: number, py: number): void {
    const f = this.frame();
    const inside = px >= f.left && px <= f.left + f.width && py >= f.top && py <= f.top + f.height;
    const place = inside ? this.at(this.fromX(px), this.fromY(py)) : null;
    this.events.hover(place?.shown ?? null, place?.n ?? 0, px, py);
  }

  private key(e: KeyboardEvent): void {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
    if (e.altKey || e.ctrlKey || e.metaKey) return;
    const centre = (): Place | null => this.at((this.window[0] + this.window[1]) / 2, (this.window[2] + this.window[3]) / 2);
    if (step) {
      this.cursor = this.cursor ? this.next(this.cursor, step, e.shiftKey ? 10 : 1) : centre();
      this.tell();
    } else if (e.key === 'Enter') {
      this.cursor ??= centre();
      if (this.cursor) this.events.pick(this.cursor.shown, this.cursor.n, e.shiftKey);
    } else if (e.key === '+' || e.key === '=' || e.key === '-') {
      const l = this.cursor?.shown.layer;
      this.zoomAbout(e.key === '-' ? 1.5 : 1 / 1.5, l?.px(this.cursor!.n), l?.py(this.cursor!.n));
    } else if (e.key === '0') this.events.zoom(null);
    else return;
    e.preventDefault();
  }

  // The next case in a direction: of a grid the cell beside it, of points the nearest of those that lie there.
  private next(from: Place, [dx, dy]: number[], cells: number): Place {
    const { layer } = from.shown;
    const { grid } = layer;
    if (grid) {
      const i = Math.max(0, Math.min(grid.nx - 1, (from.n % grid.nx) + dx * cells));
      const j = Math.max(0, Math.min(grid.ny - 1, Math.floor(from.n / grid.nx) + dy * cells));
      return { shown: from.shown, n: i + j * grid.nx };
    }
    let best = from.n;
    let least = Infinity;
    for (let n = 0; n < layer.count; n++) {
      const x = this.toX(layer.px(n)) - this.toX(layer.px(from.n));
      const y = this.toY(layer.py(from.n)) - this.toY(layer.py(n));
      const along = x * dx + y * dy;
      const aside = Math.abs(x * dy) + Math.abs(y * dx);
      if (along > 0.5 && along + 2 * aside < least) [least, best] = [along + 2 * aside, n];
    }
    return { shown: from.shown, n: best };
  }

  private tell(): void {
    if (this.cursor) {
      const { layer } = this.cursor.shown;
      const [x, y] = [layer.px(this.cursor.n), layer.py(this.cursor.n)];
      const [x0, x1, y0, y1] = this.window;
      const shift = (p: number, low: number, high: number): number => (p < low ? p - low : p > high ? p - high : 0);
      const [sx, sy] = [shift(x, x0, x1), this.y ? shift(y, y0, y1) : 0];
      if (sx || sy) this.to([x0 + sx, x1 + sx, y0 + sy, y1 + sy]);
      this.events.hover(this.cursor.shown, this.cursor.n, -1, -1);
    }
    this.redraw();
  }

  // ---- drawing ----
  private draw(): void {
    const { x, vertical } = this;
    if (!x || this.canvas.clientWidth === 0) return;
    const { g, width, height } = context(this.canvas);
    const f = this.frame();
    const ink = style('--ink');
    g.fillStyle = style('--sunk');
    g.fillRect(f.left, f.top, f.width, f.height);
    g.save();
    g.beginPath();
    g.rect(f.left, f.top, f.width, f.height);
    g.clip();
    for (const s of this.shown) {
      if (!this.y && s.colouring.number) this.drawCurve(g, s);
      else if (s.layer.grid) this.drawGrid(g, s);
      else this.drawPoints(g, s);
    }
    this.drawMarks(g);
    g.restore();
    g.strokeStyle = ink;
    g.lineWidth = 1;
    g.strokeRect(f.left - 0.5, f.top - 0.5, f.width + 1, f.height + 1);
    g.fillStyle = ink;
    g.font = '12px system-ui, sans-serif';
    g.textAlign = 'center';
    g.textBaseline = 'top';
    let end = -Infinity; // of the text before
    this.drawTics(x.tics(this.window[0], this.window[1], Math.max(2, f.width / 80)), (t) => {
      const at = this.toX(t.p);
      if (at < f.left - 1 || at > f.left + f.width + 1) return;
      g.fillRect(at - 0.5, f.top + f.height, 1, 4);
      const half = g.measureText(t.text).width / 2;
      const middle = Math.max(half, Math.min(width - half, at));
      if (middle - half < end + 4) return;
      end = middle + half;
      g.fillText(t.text, middle, f.top + f.height + 7);
    });
    g.fillText(fitted(g, x.text && x.text !== x.path ? `${x.label}: ${x.text}` : x.label, f.width), f.left + f.width / 2, height - 18);
    if (!vertical) return;
    g.textAlign = 'right';
    g.textBaseline = 'middle';
    this.drawTics(vertical.tics(this.window[2], this.window[3], Math.max(2, f.height / 45)), (t) => {
      const at = this.toY(t.p);
      if (at < f.top - 1 || at > f.top + f.height + 1) return;
      g.fillRect(f.left - 4, at - 0.5, 4, 1);
      g.fillText(fitted(g, t.text, f.left - 24), f.left - 7, Math.max(f.top + 6, at));
    });
    g.save();
    g.translate(10, f.top + f.height / 2);
    g.rotate(-Math.PI / 2);
    g.textAlign = 'center';
    g.fillText(fitted(g, vertical.label, f.height), 0, 0);
    g.restore();
  }

  private drawTics(list: Tic[], one: (t: Tic) => void): void {
    for (const t of list) one(t);
  }

  private drawGrid(g: CanvasRenderingContext2D, s: Shown): void {
    const grid = s.layer.grid!;
    let image = this.images.get(s.colouring);
    if (!image || image.done !== s.layer.done) this.images.set(s.colouring, (image = { canvas: imageOf(s), done: s.layer.done }));
    const half = (from: number, to: number, n: number): number => (n > 1 ? (to - from) / (n - 1) / 2 : 0.5);
    const hx = half(grid.x0, grid.x1, grid.nx);
    const hy = half(grid.y0, grid.y1, grid.ny);
    const [left, right] = [this.toX(grid.x0 - hx), this.toX(grid.x1 + hx)];
    const [top, bottom] = this.y ? [this.toY(grid.y1 + hy), this.toY(grid.y0 - hy)] : [this.toY(0.5), this.toY(-0.5)];
    // Colours of cells are not mixed, unless there are more cells than pixels.
    g.imageSmoothingEnabled = grid.nx > 1.5 * (right - left) || grid.ny > 1.5 * (bottom - top);
    g.imageSmoothingQuality = 'high';
    g.drawImage(image.canvas, left, top, right - left, bottom - top);
  }

  private drawPoints(g: CanvasRenderingContext2D, s: Shown): void {
    const { layer, colouring } = s;
    const f = this.frame();
    const visible = Math.max(1, layer.count * Math.min(1, (this.window[1] - this.window[0]) / (this.x!.to - this.x!.from)));
    const size = Math.max(2, Math.min(8, Math.round(Math.sqrt((f.width * f.height) / visible) * 0.7)));
    for (let n = 0; n < layer.count; n++) {
      const c = colouring.pixels(n);
      if (!c) continue;
      g.fillStyle = css(c);
      g.fillRect(this.toX(layer.px(n)) - size / 2, this.toY(this.y ? layer.py(n) : 0) - size / 2, size, size);
    }
  }

  private drawCurve(g: CanvasRenderingContext2D, s: Shown): void {
    const { layer, colouring } = s;
    const order = Array.from({ length: layer.count }, (_, n) => n).filter((n) => layer.kinds[n] !== unknown);
    if (layer.grid) {
      g.beginPath();
      let open = false;
      for (const n of order) {
        const y = colouring.number!(n);
        if (Number.isFinite(y)) g[open ? 'lineTo' : 'moveTo'](this.toX(layer.px(n)), this.toY(y));
        open = Number.isFinite(y);
      }
      g.strokeStyle = style('--muted');
      g.lineWidth = 1.5;
      g.stroke();
    }
    for (const n of order) {
      const y = colouring.number!(n);
      g.beginPath();
      g.fillStyle = css(colouring.pixels(n));
      g.strokeStyle = style('--muted');
      g.arc(this.toX(layer.px(n)), this.toY(y), 3.5, 0, 7);
      if (!Number.isFinite(y)) continue;
      g.fill();
      g.stroke();
    }
  }

  private drawMarks(g: CanvasRenderingContext2D): void {
    const height = ({ layer, n }: { layer: Layer; n: number }): number => {
      const number = this.shown.find((s) => s.layer === layer)?.colouring.number?.(n);
      return this.toY(this.y ? layer.py(n) : Number.isFinite(number) ? number! : (this.window[2] + this.window[3]) / 2);
    };
    const ring = (x: number, y: number, radius: number, colour: string, width: number): void => {
      g.beginPath();
      g.arc(x, y, radius, 0, 7);
      g.strokeStyle = colour;
      g.lineWidth = width;
      g.stroke();
    };
    for (const m of this.marks) {
      const [x, y] = [this.toX(m.layer.px(m.n)), height(m)];
      ring(x, y, 7, '#ffffff', 5);
      ring(x, y, 7, '#000000', 2);
      if (!m.text) continue;
      g.font = 'bold 12px system-ui, sans-serif';
      g.textAlign = 'left';
      g.textBaseline = 'middle';
      g.lineWidth = 4;
      g.strokeStyle = '#ffffff';
      g.strokeText(m.text, x + 11, y);
      g.fillStyle = '#000000';
      g.fillText(m.text, x + 11, y);
    }
    if (this.cursor && document.activeElement === this.canvas) {
      const { layer } = this.cursor.shown;
      const x = this.toX(layer.px(this.cursor.n));
      const y = height({ layer, n: this.cursor.n });
      for (const [colour, w] of [['#ffffff', 4], ['#000000', 2]] as const) {
        g.strokeStyle = colour;
        g.lineWidth = w;
        g.strokeRect(x - 6, y - 6, 12, 12);
      }
    }
    if (this.box) {
      const [a, b, c, d] = this.box;
      g.strokeStyle = style('--ink');
      g.lineWidth = 1.5;
      g.setLineDash([4, 3]);
      g.strokeRect(Math.min(a, c), Math.min(b, d), Math.abs(a - c), Math.abs(b - d));
      g.setLineDash([]);
    }
  }
}

const css = (c: number): string => `rgb(${c & 255},${(c >> 8) & 255},${(c >> 16) & 255})`;

function fitted(g: CanvasRenderingContext2D, text: string, width: number): string {
  if (g.measureText(text).width <= width) return text;
  let cut = text;
  while (cut.length > 3 && g.measureText(cut + '\u2026').width > width) cut = cut.slice(0, -1);
  return cut + '\u2026';
}

// Picture of a grid, a pixel a case, upper row last. While cases are missing, the latest known one of a coarser lattice
// stands for them.
function imageOf(s: Shown): HTMLCanvasElement {
  const { nx, ny } = s.layer.grid!;
  const { pixels } = s.colouring;
  const colours = new Uint32Array(nx * ny);
  for (let n = 0; n < colours.length; n++) colours[n] = pixels(n);
  const image = new ImageData(nx, ny);
  const out = new Uint32Array(image.data.buffer);
  const stand: { of: Uint32Array; size: number; across: number }[] = [];
  if (s.layer.done < s.layer.count)
    for (let size = 2; size <= coarsest; size *= 2) {
      const across = Math.ceil(nx / size);
      const of = new Uint32Array(across * Math.ceil(ny / size));
      for (let j = 0, n = 0; j < ny; j++) for (let i = 0; i < nx; i++, n++) if (colours[n]) of[Math.floor(i / size) + Math.floor(j / size) * across] = colours[n];
      stand.push({ of, size, across });
    }
  for (let j = 0, n = 0; j < ny; j++)
    for (let i = 0; i < nx; i++, n++) {
      let c = colours[n];
      for (let k = 0; !c && k < stand.length; k++) c = stand[k].of[Math.floor(i / stand[k].size) + Math.floor(j / stand[k].size) * stand[k].across];
      out[i + (ny - 1 - j) * nx] = c;
    }
  const canvas = document.createElement('canvas');
  canvas.width = nx;
  canvas.height = ny;
  canvas.getContext('2d')!.putImageData(image, 0, 0);
  return canvas;
}
