// live.ts - the panel of changes: every number and word of the scenario that may be changed, what is changed, and how the
// map is computed anew.
import { critical } from './critical';
import { el } from './dom';
import type { Field, ViewText } from './format';
import { numberText } from './numbers';
import type { Progress } from './compute';
import { pathOf, textOf, type Store, type View } from './state';

// The usual ones come first, in this order.
const usual = [
  /^ground\.friction$/, /^ground\.slope$/, /^ground\.plates\..*\.(height|from)$/, /^controller\.sample_time$/, /^controller\.torque_limit/, /noise/, /impulse|push/, /^controller\.delay$/,
  /^controller\.lag$/, /^controller\.torque_rate$/, /^ground\.restitution$/, /^controller\.(gains|kp|kd|proportional|derivative)/, /^robot\..*(mass|length|stiffness)/,
  /^initial\.(offset|state)/, /^controller\.model/, /^method\.step$/,
];
const rank = (path: string): number => {
  const k = usual.findIndex((r) => r.test(path));
  return k < 0 ? usual.length : k;
};

const pause = 250; // ms after the last change before it counts

export interface LiveEvents {
  describe(view: View): Promise<ViewText>; // throws with the reader's complaint
  stop(): void;
  command(): HTMLElement | null; // that computes the map in sight
  kind(view: View, index: number): Promise<number>; // how a case ends
  kindName(kind: number): string;
}

export class Live {
  private base = new Map<string, Field>(); // of the file itself
  private text: ViewText | null = null;
  private rows = new Map<string, { row: HTMLElement; set: (value: string) => void; error: HTMLElement }>();
  private last = ''; // path that was changed last
  private pending = new Map<string, () => void>(); // changes that do not count yet, by their paths
  private next: View = []; // with those of them that are taken
  private timer = 0;
  private turn = 0;
  private readonly search = el('input', { type: 'text', id: 'search', placeholder: 'search, as in friction or mass', 'aria-label': 'Search parameters', oninput: () => this.filter() });
  private readonly fields = el('div', { id: 'fields' });
  private readonly list = el('div', { id: 'changes' });
  private readonly problem = el('p', { class: 'error badge bad', id: 'live-problem', role: 'alert', hidden: true });
  private readonly bar = el('progress', { max: 1, value: 0, 'aria-label': 'Map computed', hidden: true });
  private readonly told = el('p', { class: 'muted', id: 'progress', role: 'status' });
  private readonly cells = el('select', { id: 'cells', 'aria-label': 'Cells of the computed map along each axis', onchange: () => this.request(true) },
    ...[32, 64, 128, 256].map((n) => el('option', { value: n, selected: n === 64 }, `${n} \u00d7 ${n}`)), el('option', { value: 0 }, "the file's places"));
  private readonly all = el('input', { type: 'checkbox', id: 'all-cases', onchange: () => this.request(true) });
  private readonly compute = el('button', { type: 'button', id: 'compute', onclick: () => this.request(false) }, 'compute this window');
  private readonly stop = el('button', { type: 'button', id: 'stop', hidden: true, onclick: () => this.events.stop() }, 'stop');
  private readonly reproduce = el('div', {});

  constructor(
    private readonly part: HTMLElement,
    private readonly store: Store,
    private readonly map: boolean,
    private readonly events: LiveEvents,
  ) {}

  async start(): Promise<void> {
    let text: ViewText;
    try {
      text = await this.events.describe([]);
    } catch (problem) {
      this.part.replaceChildren(el('p', { class: 'empty', id: 'refused' }, `Here nothing can be simulated or changed: ${(problem as Error).message}`));
      return;
    }
    this.base = new Map(text.fields.map((f) => [f.path, f]));
    const controls = el('div', { class: 'row' }, el('label', {}, 'Map ', this.cells), el('label', {}, this.all, ' every case'), this.compute, this.stop);
    this.part.replaceChildren(el('h2', {}, 'Change something'), this.list, this.problem, ...(this.map ? [controls, this.bar, this.told, this.reproduce] : []), this.search, this.fields);
    this.show(text);
    this.update();
  }

  // ---- the state ----
  update(): void {
    const { changes, map } = this.store.state;
    if (map) {
      this.cells.value = String(map.cells);
      this.all.checked = map.all;
    }
    this.list.replaceChildren(
      ...changes.map((c) => {
        const model = this.modelOf(c, changes);
        const told = model ? ` \u2014 the controller stays the one designed for ${model} = ${textOf(c)}` : '';
        return el('div', { class: 'change' }, el('span', {}, el('code', {}, c), told),
          el('button', { type: 'button', class: 'small', 'aria-label': `Take back ${pathOf(c)}`, onclick: () => this.set(changes.filter((x) => x !== c)) }, '\u00d7'));
      }),
      ...(changes.length > 1 ? [el('button', { type: 'button', class: 'small', onclick: () => this.set([]) }, 'take back all')] : []),
    );
    const given = new Map(changes.map((c) => [pathOf(c), textOf(c)]));
    for (const [path, { row, set }] of this.rows) {
      row.classList.toggle('changed', given.has(path));
      set(given.get(path) ?? this.fileText(path));
    }
    const command = changes.length || map ? this.events.command() : null;
    this.reproduce.replaceChildren(...(command ? [el('details', {}, el('summary', { class: 'muted' }, 'command that computes this map'), command)] : []));
    void this.check(changes);
  }

  private fileText(path: string): string {
    const value = this.base.get(path)?.value ?? null;
    return value === null ? '' : String(value);
  }

  // What a change of controller.model keeps as the design has it, or null.
  private modelOf(change: string, changes: View): string | null {
    const path = pathOf(change);
    if (!path.startsWith('controller.model.')) return null;
    const rest = path.slice('controller.model.'.length);
    return [`robot.${rest}`, `ground.${rest}`].find((p) => changes.some((c) => pathOf(c) === p)) ?? null;
  }

  // Fields of the changed scenario; what it does not admit is said where it was changed.
  private async check(changes: View): Promise<void> {
    const turn = ++this.turn;
    for (const { error } of this.rows.values()) error.textContent = '';
    this.problem.hidden = true;
    try {
      const text = await this.events.describe(changes);
      if (turn === this.turn && text !== this.text) this.show(text);
    } catch (problem) {
      if (turn !== this.turn) return;
      const message = (problem as Error).message;
      const row = this.rows.get(this.last);
      if (row && changes.some((c) => pathOf(c) === this.last)) row.error.textContent = message;
      this.problem.textContent = message;
      this.problem.hidden = row !== undefined && row.error.textContent !== '' && row.row.offsetParent !== null;
    }
  }

  private set(changes: View): void {
    const { state } = this.store;
    let { map } = state;
    if (this.map && changes.length && !map) map = { cells: Number(this.cells.value), window: null, all: this.all.checked };
    if (!changes.length && map && !map.window) map = null;
    this.store.set({ changes, map, show: state.show === 'file' ? 'now' : state.show });
  }

  // Why the map cannot be computed, unless it stands at a field already.
  refused(problem: unknown): void {
    const message = (problem as Error).message;
    if ([...this.rows.values()].some((r) => r.error.textContent === message)) return;
    this.problem.textContent = message;
    this.problem.hidden = false;
  }

  // A field has another value; the file's own value takes the change back.
  private change(field: Field, value: string): void {
    this.last = field.path;
    clearTimeout(this.timer);
    this.pending.set(field.path, () => {
      const model = this.designModel(field.path);
      let changes = this.next.filter((c) => pathOf(c) !== field.path);
      const back = value.trim() === '' || value === this.fileText(field.path);
      if (back && model) changes = changes.filter((c) => pathOf(c) !== model);
      if (!back) {
        if (model && !changes.some((c) => pathOf(c) === model)) changes.push(`${model}=${this.fileText(field.path)}`);
        changes.push(`${field.path}=${value}`);
      }
      this.next = changes;
    });
    this.timer = window.setTimeout(() => {
      this.next = this.store.state.changes;
      for (const take of this.pending.values()) take();
      this.pending.clear();
      this.set(this.next);
    }, pause);
  }

  // The controller is designed for a model; where the robot or the ground changes, the model stays the file's.
  private designModel(path: string): string | null {
    const rest = /^(robot\.|ground\.(?=slope$|gravity$))(.*)/.exec(path)?.[2];
    const model = `controller.model.${rest}`;
    return rest && this.text?.designed && this.base.has(model) ? model : null;
  }

  // How far a number may go either way before the first case that is played ends otherwise.
  private async seek(f: Field, ends: [number, number], told: HTMLElement): Promise<void> {
    const ref = this.store.state.cases[0];
    if (!ref) throw new Error('of which case? Click one.');
    const model = this.designModel(f.path);
    const others = ref.view.filter((c) => pathOf(c) !== f.path);
    if (model && !others.some((c) => pathOf(c) === model)) others.push(`${model}=${this.fileText(f.path)}`);
    const from = Number(ref.view.filter((c) => pathOf(c) === f.path).map(textOf).pop() ?? this.fileText(f.path));
    if (!Number.isFinite(from)) throw new Error('it is no number to begin with');
    const simulate = (x: number): Promise<number> => this.events.kind([...others, `${f.path}=${x}`], ref.index);
    told.textContent = '\u2026';
    const of = await simulate(from);
    const say: string[] = [];
    for (const [word, to] of [['up to', ends[1]], ['down to', ends[0]]] as const) {
      if (word === 'up to' ? to <= from : to >= from) continue;
      const c = await critical(simulate, of, from, to);
      const again = c.again.map(([a, b]) => `${numberText(a, 4)} \u2026 ${numberText(b, 4)}`).join(', ');
      say.push(`${word} ${numberText(c.kept, 5)}${c.lost === null ? ' and perhaps beyond' : ` (then ${this.events.kindName(c.kind)}${again ? `; again ${again}` : ''})`}`);
    }
    told.textContent = `case ${ref.index} is ${this.events.kindName(of)} ${say.join(', ')}`;
  }

  // The map is computed anew: with another resolution, or of the window in sight.
  private request(resize: boolean): void {
    const { state } = this.store;
    if (resize && !state.map) return;
    const window = resize ? state.map!.window : state.zoom;
    this.store.set({ map: { cells: Number(this.cells.value), window, all: this.all.checked }, show: state.show === 'file' ? 'now' : state.show });
  }

  progress(p: Progress | null, running: boolean): void {
    this.bar.hidden = !running;
    this.stop.hidden = !running;
    if (!p) {
      this.told.textContent = '';
      return;
    }
    this.bar.value = p.asked ? p.simulated / p.asked : 0;
    this.told.textContent = `${p.simulated} of ${p.asked} cases simulated, ${p.seconds.toFixed(1)} s${running ? '' : p.stopped ? ': stopped' : ': done'}`;
    this.told.dataset.running = String(running);
  }

  // ---- the fields ----
  private show(text: ViewText): void {
    const same = this.text && this.text.fields.length === text.fields.length && this.text.fields.every((f, k) => f.path === text.fields[k].path);
    this.text = text;
    if (same) return;
    const sorted = text.fields.map((f, k) => ({ f, k })).sort((a, b) => rank(a.f.path) - rank(b.f.path) || a.k - b.k);
    this.rows.clear();
    this.fields.replaceChildren(...sorted.map(({ f }) => this.row(f)));
    const given = new Map(this.store.state.changes.map((c) => [pathOf(c), textOf(c)]));
    for (const [path, { row, set }] of this.rows) {
      row.classList.toggle('changed', given.has(path));
      set(given.get(path) ?? this.fileText(path));
    }
    this.filter();
  }

  private row(f: Field): HTMLElement {
    const id = `field-${f.path}`;
    const error = el('p', { class: 'error', role: 'alert' });
    const name = el('label', { for: id }, el('b', {}, f.path), el('span', { class: 'muted' }, `${f.text}${f.unit && f.unit !== '1' ? `, ${f.unit}` : ''}${f.swept ? ' (varies over the map)' : ''}${f.design && this.text!.designed ? ' (needs a design)' : ''}`));
    const top = el('div', { class: 'top' });
    const row = el('div', { class: 'field', 'data-path': f.path }, name, top, error);
    if (f.type === 'word') {
      const select = el('select', { id, disabled: f.swept, onchange: () => this.change(f, select.value) }, ...(f.words ?? []).map((w) => el('option', { value: w }, w)));
      top.append(select);
      this.rows.set(f.path, { row, error, set: (v) => (select.value = v) });
      return row;
    }
    const range = f.low !== null || f.high !== null ? `${f.low === null ? '' : numberText(f.low)} \u2026 ${f.high === null ? '' : numberText(f.high)}` : '';
    const input = el('input', { id, type: f.words ? 'text' : 'number', step: f.type === 'integer' ? 1 : 'any', disabled: f.swept, title: range, oninput: () => this.change(f, input.value) });
    const slider = el('input', { type: 'range', 'aria-label': `${f.path}, slider`, disabled: f.swept, oninput: () => {
      input.value = slider.value;
      this.change(f, slider.value);
    } });
    top.append(slider, input);
    if (f.type === 'number' && !f.swept) {
      const told = el('p', { class: 'muted critical', role: 'status' });
      const ask = (): void => void this.seek(f, [Number(slider.min), Number(slider.max)], told).catch((problem: Error) => (told.textContent = problem.message));
      top.append(el('button', { type: 'button', class: 'small', title: 'how far this number may go, within the slider, before the case that is played ends otherwise', onclick: ask }, 'how far?'));
      row.append(told);
    }
    this.fit(slider, f, Number(f.value ?? NaN));
    this.rows.set(f.path, { row, error, set: (v) => {
      if (document.activeElement !== input) input.value = v;
      if (document.activeElement !== slider) {
        const x = Number(v);
        if (v !== '' && (x < Number(slider.min) || x > Number(slider.max))) this.fit(slider, f, x);
        slider.value = v;
      }
      slider.disabled = f.swept || Number.isNaN(Number(v));
    } });
    return row;
  }

  // A slider around a value, within the field's range.
  private fit(slider: HTMLInputElement, f: Field, x: number): void {
    const value = Number.isFinite(x) ? x : 0;
    const bounded = f.low !== null && f.high !== null && f.high - f.low <= 10;
    let [low, high] = value === 0 ? [-1, 1] : [Math.min(0, 2 * value), Math.max(0, 2 * value)];
    if (value !== 0 && (f.low === null || f.low < 0)) [low, high] = [value - Math.abs(value), value + Math.abs(value)];
    if (bounded && value === 0) [low, high] = [f.low!, f.high!];
    if (f.low !== null) low = Math.max(low, f.low);
    if (f.high !== null) high = Math.min(high, f.high);
    const step = f.type === 'integer' ? 1 : 10 ** Math.floor(Math.log10((high - low) / 100 || 1e-3));
    slider.min = String(Number((Math.floor(low / step) * step).toPrecision(12)));
    slider.max = String(Number((f.type === 'integer' ? Math.max(high, low + 1) : high).toPrecision(12)));
    slider.step = String(Number(step.toPrecision(3)));
    if (f.low !== null && Number(slider.min) < f.low) slider.min = String(f.low);
  }

  private filter(): void {
    const words = this.search.value.toLowerCase().split(/\s+/);
    for (const [path, { row }] of this.rows) {
      const text = `${path} ${this.text?.fields.find((f) => f.path === path)?.text ?? ''}`.toLowerCase();
      row.hidden = !words.every((w) => text.includes(w));
    }
  }
}
