// map_part.ts - the part of the page with the map: what it shows of the state, and the controls around it.
import { compute, type Progress } from './compute';
import type { Data } from './data';
import { byId, command, complain, el, options } from './dom';
import type { ViewText } from './format';
import { fileLayer, unknown, type Computed, type Layer } from './layers';
import { MapView, type Mark, type Shown } from './map';
import { numberText, withUnit } from './numbers';
import { colouring, differenceColouring, drawLegend, type Colouring } from './paint';
import { fileName } from './pages';
import type { Pool } from './pool';
import { requestLayer } from './request';
import { scalesOf, type Scale } from './scales';
import { sameView, type CaseRef, type MapRequest, type State, type Store } from './state';
import { shellWord } from './wire';

export class MapPart {
  readonly scales: Scale[];
  private readonly view: MapView;
  private file: Layer | null = null;
  private computed: Computed | null = null;
  private shown: Shown[] = [];
  private abort: AbortController | null = null;
  private job = ''; // what the computed layer is of
  private halted: MapRequest | null = null; // the request that was stopped: a like one begins anew
  private turn = 0;
  private hovered = 0;
  private repaint = 0;

  constructor(
    private readonly data: Data,
    private readonly store: Store,
    private readonly pool: Promise<Pool | null>,
    private readonly progress: (p: Progress | null, running: boolean) => void,
    private readonly failed: (problem: unknown) => void,
  ) {
    this.scales = scalesOf(data);
    this.view = new MapView(byId('map') as HTMLCanvasElement, {
      hover: (shown, n, x, y) => void this.hover(shown, n, x, y).catch(complain),
      pick: (shown, n, add) => this.pick(shown, n, add),
      zoom: (zoom) => store.set({ zoom }, true),
    });
    this.controls();
  }

  scale = (path: string): Scale | null => this.scales.find((s) => s.path === path) ?? null;

  private controls(): void {
    const { store } = this;
    const on = <K extends 'colour' | 'x' | 'y'>(id: K): void => {
      const select = byId<HTMLSelectElement>(id);
      select.addEventListener('change', () => store.set({ [id]: select.value, ...(id === 'colour' ? {} : { zoom: null, map: windowless(store.state) }) } as Partial<State>));
    };
    on('colour');
    on('x');
    on('y');
    byId('zoom-in').addEventListener('click', () => this.view.zoomAbout(1 / 1.5));
    byId('zoom-out').addEventListener('click', () => this.view.zoomAbout(1.5));
    byId('zoom-all').addEventListener('click', () => store.set({ zoom: null }));
  }

  // ---- from the state to the picture ----
  async update(now: State, before: State | null): Promise<void> {
    const x = this.scale(now.x);
    if (!x) return;
    const y = this.scale(now.y);
    const turn = ++this.turn;
    const moved = !before || !this.file || now.x !== before.x || now.y !== before.y || now.at.some((p, k) => p !== before.at[k]);
    if (moved || now.colour !== before.colour) this.selects(now);
    if (moved) this.file = await fileLayer(this.data, x, y, now.at);
    if (turn !== this.turn) return;
    this.prepare(now, x, y);
    await this.paint(turn, x, y);
  }

  // Starts or stops computing, as the state has it.
  private prepare(now: State, x: Scale, y: Scale | null): void {
    const job = now.map ? JSON.stringify([now.map, now.changes, now.x, now.y, now.at]) : '';
    if (job === this.job && (!this.halted || this.halted === now.map)) return;
    this.job = job;
    this.halted = null;
    this.abort?.abort();
    const abort = (this.abort = new AbortController());
    this.computed = null;
    if (!now.map) this.progress(null, false);
    else void this.run(now, x, y, abort).catch((problem: unknown) => {
      if (abort.signal.aborted) return;
      this.progress(null, false);
      this.failed(problem);
    });
  }

  private async run(now: State, x: Scale, y: Scale | null, abort: AbortController): Promise<void> {
    const pool = await this.pool;
    if (!pool) return;
    const base = await pool.ask<ViewText>([], 'describe', [], true);
    const layer = await requestLayer(this.data, base, pool.columns, this.file!, x, y, now.at, now.changes, now.map!);
    await pool.ask<ViewText>(layer.view, 'describe', [], true); // complains before anything is painted
    if (abort.signal.aborted) return;
    this.computed = layer;
    this.store.set({}, true); // others ask for the command
    let painted = 0;
    const told = (p: Progress, running: boolean): void => {
      if (this.computed !== layer) return;
      this.progress(p, running);
      if (running && performance.now() - painted < 120) return;
      painted = performance.now();
      void this.paint(this.turn, x, y).catch(complain);
    };
    let last: Progress = { simulated: 0, asked: 0, seconds: 0 };
    // A grid that is the whole sweep can be refined.
    const whole = layer.grid !== null && layer.view.some((s) => s.startsWith('sweep=')) || layer.count === this.data.head.cases;
    await compute(pool, layer, now.map!.all || !whole, abort.signal, (p) => told((last = p), true));
    told({ ...last, stopped: abort.signal.aborted }, false);
  }

  stop(): void {
    this.halted = this.store.state.map;
    this.abort?.abort();
  }

  command(): HTMLElement | null {
    const { computed, data } = this;
    if (!computed) return null;
    const sets = computed.view.map((s) => ` --set ${shellWord(s)}`).join('');
    return el('div', {}, command(`stance run ${shellWord(fileName(data))}${sets} -o anew.h5`), el('p', { class: 'muted' }, `${fileName(data)}: the scenario, which the tab Scenario saves`));
  }

  private async paint(turn: number, x: Scale, y: Scale | null): Promise<void> {
    const { state } = this.store;
    const { file, computed } = this;
    if (!file) return;
    const layers: Layer[] = [];
    // Under a computed map that has other parameters the file's is not shown: it would lie.
    if (!computed || state.show === 'file' || (sameView(state.changes, []) && state.show === 'now')) layers.push(file);
    if (computed && state.show !== 'file') layers.push(computed);
    const paintings = await Promise.all(layers.map((l) => this.colours(l, state)));
    if (turn !== this.turn || computed !== this.computed) return;
    this.shown = layers.map((layer, k) => ({ layer, colouring: paintings[k] }));
    this.view.show(this.shown, x, y, state.zoom, await this.marks(state));
    drawLegend(byId('legend'), paintings[paintings.length - 1]);
    this.describe(x, y);
    this.choices(state);
  }

  private async colours(layer: Layer, state: State): Promise<Colouring> {
    if (layer.computed && state.show === 'difference') return differenceColouring(this.data, this.file!, layer);
    return colouring(this.data, layer, state.colour);
  }

  redraw(): void {
    clearTimeout(this.repaint);
    this.repaint = window.setTimeout(() => {
      const { state } = this.store;
      const x = this.scale(state.x);
      if (x) void this.paint(this.turn, x, this.scale(state.y)).catch(complain);
    });
  }

  // ---- the controls ----
  private selects(now: State): void {
    const { head } = this.data;
    const answers = head.answers.filter((a) => a.block && a.name !== 'outcome').map((a) => ({ value: a.name, text: a.name }));
    options(byId<HTMLSelectElement>('colour'), [{ value: 'outcome', text: 'outcome' }, ...answers], now.colour);
    const paths = this.scales.map((s) => ({ value: s.path, text: s.path }));
    options(byId<HTMLSelectElement>('x'), paths.filter((p) => p.value !== now.y), now.x);
    options(byId<HTMLSelectElement>('y'), [{ value: '', text: this.scales.length > 1 ? '(none)' : '-' }, ...paths.filter((p) => p.value !== now.x)], now.y);
    byId<HTMLSelectElement>('x').disabled = byId<HTMLSelectElement>('y').disabled = this.scales.length < 2;
    document.querySelector('main')!.classList.toggle('strip', now.y === '');
    this.sliders(now);
  }

  // One for each axis that the map does not show.
  private sliders(now: State): void {
    const shown = [now.x, now.y].map((p) => this.scale(p)?.axis);
    const { axes, head } = this.data;
    const wanted = axes.map((a, k) => ({ a, k })).filter(({ a, k }) => !shown.includes(k) && a.count > 1);
    const box = byId('sliders');
    const key = wanted.map(({ k }) => k).join();
    if (box.dataset.of !== key) {
      box.dataset.of = key;
      box.replaceChildren(...wanted.map(({ a, k }) => el('div', { class: 'slider', 'data-axis': k }, el('label', { for: `slider-${k}` }, a.path), el('output', {}),
        el('input', { id: `slider-${k}`, type: 'range', min: 0, max: a.count - 1, step: 1, oninput: (e: Event) => {
          const at = [...this.store.state.at];
          at[k] = Number((e.target as HTMLInputElement).value);
          this.store.set({ at }, true);
        } }))));
    }
    for (const { a, k } of wanted) {
      const row = box.querySelector(`[data-axis="${k}"]`)!;
      const input = row.querySelector('input')!;
      const text = k === head.sample ? `point ${now.at[k] + 1} of ${a.count}: ${this.sampled(now.at[k])}` : this.axisText(k, now.at[k]);
      input.value = String(now.at[k]);
      input.setAttribute('aria-valuetext', text);
      row.querySelector('output')!.textContent = text;
    }
  }

  private axisText(k: number, place: number): string {
    const a = this.data.axes[k];
    return a.words ? a.words[a.values[place]] : withUnit(numberText(a.values[place]), a.unit);
  }

  private sampled(point: number): string {
    return this.data.head.varied.map((v) => `${v.path} = ${v.words ? v.words[v.values[point]] : withUnit(numberText(v.values[point], 4), v.unit)}`).join(', ');
  }

  // Now, the file, or the difference: where something is computed.
  private choices(state: State): void {
    const group = byId('show');
    group.hidden = !this.computed;
    const one = (show: State['show'], text: string): HTMLElement =>
      el('button', { type: 'button', class: 'small', 'aria-pressed': String(state.show === show), onclick: () => this.store.set({ show }) }, text);
    if (group.dataset.of !== state.show) group.replaceChildren(one('now', 'computed'), one('file', 'file'), one('difference', 'difference'));
    group.dataset.of = state.show;
  }

  private describe(x: Scale, y: Scale | null): void {
    const top = this.shown.at(-1);
    if (!top) return;
    const counts = top.colouring.entries.map((e) => `${e.count} ${e.name}`).join(', ');
    const canvas = byId('map');
    canvas.setAttribute('aria-label', `Map of ${top.colouring.title} over ${x.path}${y ? ` and ${y.path}` : ''}: ${counts}`);
    canvas.dataset.done = String(top.layer.done);
    canvas.dataset.cases = String(top.layer.count);
    canvas.dataset.computed = String(top.layer.computed);
  }

  // ---- cases ----
  private async marks(state: State): Promise<Mark[]> {
    const top = this.shown.at(-1)?.layer;
    const marks: Mark[] = [];
    state.cases.forEach((c, k) => {
      for (const layer of [this.file!, top])
        if (layer && (layer.computed ? sameView(c.view, layer.view) : !c.view.some((s) => s.startsWith('sweep=')))) {
          const n = layer.of(c.index);
          if (n >= 0) {
            marks.push({ layer, n, text: state.cases.length > 1 ? String(k + 1) : '' });
            break;
          }
        }
    });
    return marks;
  }

  private pick(shown: Shown, n: number, add: boolean): void {
    const { state } = this.store;
    const ref = { index: shown.layer.index(n), view: shown.layer.view };
    const others = add ? state.cases.filter((c) => JSON.stringify(c) !== JSON.stringify(ref)) : [];
    this.store.set({ cases: [...others.slice(-3), ref], time: 0 });
  }

  // Where a case of the file is, or what it was set to.
  where(ref: CaseRef): string {
    if (ref.view.some((s) => s.startsWith('sweep='))) {
      const layer = this.computed && sameView(this.computed.view, ref.view) ? this.computed : null;
      const n = layer?.of(ref.index) ?? -1;
      const [x, y] = [this.scale(this.store.state.x), this.scale(this.store.state.y)];
      const place = layer && n >= 0 && x ? `${x.path} = ${x.say(layer.px(n))}${y ? `, ${y.path} = ${y.say(layer.py(n))}` : ''}; ` : '';
      return place + ref.view.filter((s) => !s.startsWith('sweep=')).join(', ');
    }
    const changes = ref.view.length ? `; ${ref.view.join(', ')}` : '';
    return (this.data.head.single ? '' : this.placeText(ref.index)) + changes;
  }

  private placeText(index: number): string {
    const places = this.data.places(index);
    return this.data.axes.map((a, k) => (k === this.data.head.sample ? this.sampled(places[k]) : `${a.path} = ${this.axisText(k, places[k])}`)).join(', ');
  }

  private async hover(shown: Shown | null, n: number, px: number, py: number): Promise<void> {
    const tip = byId('tip');
    const turn = ++this.hovered;
    if (!shown) {
      tip.hidden = true;
      return;
    }
    const { layer } = shown;
    const { head } = this.data;
    const kind = layer.kinds[n];
    const index = layer.index(n);
    const where = layer.view.some((s) => s.startsWith('sweep=')) ? this.where({ index, view: layer.view }) : this.placeText(index);
    const state = kind === unknown ? 'not computed yet' : head.kinds[kind].name + (layer.inferred?.[n] ? ' (inferred, not simulated)' : '');
    const facts: [string, string][] = [];
    if (kind !== unknown && !layer.inferred?.[n])
      for (const a of head.answers) {
        if (a.name === 'outcome') continue;
        const get = await layer.answer(a);
        if (!get) continue;
        const v = get(n);
        if (Number.isNaN(v)) continue;
        facts.push([a.name, a.words ? (a.words[v] ?? '-') : withUnit(numberText(v), a.unit)]);
      }
    if (turn !== this.hovered) return;
    const coloured = facts.find(([name]) => name === this.store.state.colour);
    tip.textContent = [`case ${index}: ${state}`, ...where.split(/[,;] /), ...(coloured ? [coloured.join(' ')] : [])].join('\n');
    tip.hidden = px < 0;
    if (px >= 0) {
      const box = byId('map-box');
      tip.style.left = `${Math.max(0, Math.min(px + 14, box.clientWidth - tip.offsetWidth - 4))}px`;
      tip.style.top = `${py + 14 + tip.offsetHeight > box.clientHeight ? Math.max(0, py - tip.offsetHeight - 10) : py + 14}px`;
    }
    byId('readout').replaceChildren(el('p', {}, el('b', {}, `case ${index}`), ` ${where}: `, el('b', {}, state)), el('dl', { class: 'facts' }, ...facts.map(([name, text]) => el('div', {}, el('dt', {}, name), el('dd', {}, text)))));
  }
}

// The request of a map without its window, which belongs to other axes.
const windowless = (s: State): State['map'] => (s.map ? (s.changes.length ? { ...s.map, window: null } : null) : null);
