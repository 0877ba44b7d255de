// state.ts - what is seen, and the address that says it. A link shows the same; back and forward work.
import { complain } from './dom';

// A view is what is simulated: the file's scenario with these values set, each `path=text` as after --set.
export type View = string[];

export interface CaseRef {
  index: number;
  view: View;
}

export interface MapRequest {
  cells: number; // along each axis; 0: the file's own places
  window: number[] | null; // places x0, x1, y0, y1 between which; null: all
  all: boolean; // every case is simulated; else those where outcomes differ
}

export interface State {
  x: string;
  y: string;
  at: number[]; // place along each axis of the file
  colour: string; // 'outcome', or the name of an answer
  zoom: number[] | null; // x0, x1, y0, y1 in places
  cases: CaseRef[];
  beside: boolean; // cases side by side, else one over the other
  time: number;
  changes: View;
  map: MapRequest | null;
  show: 'now' | 'file' | 'difference';
  tab: string;
}

export const sameView = (a: View, b: View): boolean => a.length === b.length && a.every((s, k) => s === b[k]);
export const sameCase = (a: CaseRef, b: CaseRef): boolean => a.index === b.index && sameView(a.view, b.view);
export const pathOf = (set: string): string => set.slice(0, set.indexOf('='));
export const textOf = (set: string): string => set.slice(set.indexOf('=') + 1);

const short = (x: number): string => String(Number(x.toPrecision(7)));

export function encode(s: State, initial: State): string {
  const parts: string[] = [];
  const put = (key: string, value: string): number => parts.push(`${key}=${encodeURIComponent(value).replace(/%2C/g, ',').replace(/%3D/g, '=')}`);
  for (const key of ['x', 'y', 'colour', 'show', 'tab'] as const) if (s[key] !== initial[key]) put(key, s[key]);
  if (s.at.some((p, k) => p !== initial.at[k])) put('at', s.at.join(','));
  if (s.zoom) put('zoom', s.zoom.map(short).join(','));
  for (const c of s.cases) put('case', c.view.length ? `${c.index};${JSON.stringify(c.view)}` : String(c.index));
  if (s.beside !== initial.beside) put('beside', s.beside ? '1' : '0');
  if (s.cases.length && s.time > 0) put('t', short(s.time));
  for (const c of s.changes) put('set', c);
  if (s.map) put('map', [s.map.cells, s.map.all ? 'all' : 'refined', ...(s.map.window ?? []).map(short)].join(','));
  return parts.join('&');
}

// The state that an address says; what it does not say, or says wrongly, is as `initial`.
export function decode(hash: string, initial: State, cases: number): State {
  const s: State = { ...initial, cases: [], changes: [] };
  const numbers = (text: string, count: number): number[] | null => {
    const list = text.split(',').map(Number);
    return list.length === count && list.every(Number.isFinite) ? list : null;
  };
  for (const part of hash.replace(/^#/, '').split('&')) {
    const cut = part.indexOf('=');
    if (cut < 0) continue;
    const key = part.slice(0, cut);
    let value = '';
    try {
      value = decodeURIComponent(part.slice(cut + 1));
    } catch {
      continue;
    }
    if (key === 'x' || key === 'y' || key === 'colour' || key === 'tab') s[key] = value;
    else if (key === 'show' && (value === 'now' || value === 'file' || value === 'difference')) s.show = value;
    else if (key === 'at') s.at = numbers(value, initial.at.length)?.map(Math.round) ?? s.at;
    else if (key === 'zoom') s.zoom = numbers(value, 4);
    else if (key === 'beside') s.beside = value === '1';
    else if (key === 't') s.time = Math.max(0, Number(value)) || 0;
    else if (key === 'set' && value.indexOf('=') > 0 && !value.startsWith('sweep')) s.changes.push(value); // a map has its own places
    else if (key === 'case') {
      const [index, ...view] = value.split(';');
      try {
        const ref = { index: Number(index), view: view.length ? (JSON.parse(view.join(';')) as View) : [] };
        const known = Number.isInteger(ref.index) && ref.index >= 0 && (ref.view.length > 0 || ref.index < cases);
        if (known && ref.view.every((v) => typeof v === 'string' && v.includes('=')) && s.cases.length < 8) s.cases.push(ref);
      } catch {
        continue;
      }
    } else if (key === 'map') {
      const [cells, all, ...window] = value.split(',');
      const n = Number(cells);
      if (Number.isInteger(n) && n >= 0 && n <= 1024)
        s.map = { cells: n, all: all === 'all', window: numbers(window.join(','), 4) };
    }
  }
  return s;
}

export class Store {
  state: State;
  private listeners: ((now: State, before: State) => void)[] = [];
  private timer = 0;

  constructor(
    readonly initial: State,
    private readonly valid: (s: State) => State,
    private readonly cases: number,
  ) {
    this.state = valid(decode(location.hash, initial, cases));
    window.addEventListener('popstate', () => this.read());
    window.addEventListener('hashchange', () => this.read());
  }

  listen(f: (now: State, before: State) => void): void {
    this.listeners.push(f);
  }

  private read(): void {
    if (location.hash.replace(/^#/, '') !== encode(this.state, this.initial)) this.change(this.valid(decode(location.hash, this.initial, this.cases)));
  }

  private change(next: State): void {
    const before = this.state;
    this.state = next;
    for (const f of this.listeners) {
      try {
        f(next, before);
      } catch (problem) {
        complain(problem);
      }
    }
  }

  // A step that "back" undoes, or, with `passing`, one of many small ones.
  set(patch: Partial<State>, passing = false): void {
    this.change(this.valid({ ...this.state, ...patch }));
    if (!passing) {
      clearTimeout(this.timer);
      this.timer = 0;
      this.write('pushState');
    } else if (!this.timer) this.timer = window.setTimeout(() => ((this.timer = 0), this.write('replaceState')), 300);
  }

  private write(how: 'pushState' | 'replaceState'): void {
    const hash = '#' + encode(this.state, this.initial);
    if (hash === (location.hash || '#')) return;
    try {
      history[how](null, '', hash);
    } catch {
      location.hash = hash; // a browser that keeps history from files
    }
  }
}
