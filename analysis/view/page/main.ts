// main.ts - the page: reads its data, its state from the address, and puts the parts together.
import { Cases } from './cases';
import { chartsPage } from './charts';
import { Data, isCut, whole } from './data';
import { byId, complain, el } from './dom';
import type { Results } from './engine';
import type { ViewText } from './format';
import { Live } from './live';
import { MapPart } from './map_part';
import { aboutPage, scenarioPage } from './pages';
import { lacking, Pool } from './pool';
import { leastWidth, scalesOf } from './scales';
import { sameCase, Store, type State } from './state';

// What is seen at first: axes of offsets, else factors of the sample, else the last two axes.
function initialState(data: Data): State {
  const { head, axes } = data;
  const scales = scalesOf(data);
  const offsets = scales.filter((s) => s.varied < 0 && axes[s.axis].offset);
  const factors = scales.filter((s) => s.varied >= 0);
  const plain = scales.filter((s) => s.varied < 0);
  const [x, y] = offsets.length > 1 ? offsets : factors.length > 1 ? factors : plain.length > 1 ? plain.slice(-2) : [...plain, ...factors];
  const at = axes.map((a) => (a.offset ? a.values.reduce((best, v, i) => (Math.abs(v) < Math.abs(a.values[best]) ? i : best), 0) : 0));
  return {
    x: x?.path ?? '', y: y?.path ?? '', at, colour: 'outcome', zoom: null, cases: head.cases === 1 ? [{ index: head.index, view: [] }] : [],
    beside: false, time: 0, changes: [], map: null, show: 'now', tab: head.cases > 0 ? 'map' : 'charts',
  };
}

// A state that this page can show, whatever an address says.
function valid(data: Data, initial: State, s: State): State {
  const scales = scalesOf(data);
  const known = (path: string): boolean => scales.some((k) => k.path === path);
  const x = known(s.x) ? s.x : initial.x;
  const y = s.y === '' || (known(s.y) && s.y !== x) ? s.y : initial.y === x ? (scales.find((k) => k.path !== x)?.path ?? '') : initial.y;
  const at = s.at.map((p, k) => Math.max(0, Math.min(data.axes[k].count - 1, p)));
  const carried = s.colour === 'outcome' || data.head.answers.some((a) => a.name === s.colour && a.block);
  const within = (path: string, from: number, to: number): boolean => {
    const scale = scales.find((k) => k.path === path);
    const some = scale ? 1e-3 * (scale.to - scale.from) : 0; // an address rounds
    return !scale || (from >= scale.from - some && to <= scale.to + some && to - from > 0.5 * leastWidth(scale));
  };
  const zoom = s.zoom && within(x, s.zoom[0], s.zoom[1]) && within(y, s.zoom[2], s.zoom[3]) ? s.zoom : null;
  const own = { index: data.head.index, view: [] };
  const cases = data.head.cases === 1 && !s.cases.some((c) => sameCase(c, own)) ? [...s.cases, own] : s.cases;
  return { ...s, x, y, at, zoom, cases, colour: carried ? s.colour : 'outcome' };
}

function theme(redraw: () => void): void {
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const root = document.documentElement;
  const set = (name: string): void => {
    root.dataset.theme = name;
    redraw();
  };
  set(dark.matches ? 'dark' : 'light');
  dark.addEventListener('change', () => set(dark.matches ? 'dark' : 'light'));
  byId('theme').addEventListener('click', () => set(root.dataset.theme === 'dark' ? 'light' : 'dark'));
}

function tabs(names: [string, string][], store: Store, opened: (tab: string) => void): void {
  const bar = byId('tabs');
  const buttons = names.map(([id, text]) => el('button', { type: 'button', role: 'tab', id: `tab-${id}`, 'aria-controls': `panel-${id}`, onclick: () => store.set({ tab: id }) }, text));
  bar.append(...buttons);
  bar.addEventListener('keydown', (e) => {
    const step = e.key === 'ArrowRight' ? 1 : e.key === 'ArrowLeft' ? -1 : 0;
    const at = names.findIndex(([id]) => id === store.state.tab);
    if (!step) return;
    const next = (at + step + names.length) % names.length;
    store.set({ tab: names[next][0] });
    buttons[next].focus();
  });
  const show = (): void => {
    const tab = names.some(([id]) => id === store.state.tab) ? store.state.tab : names[0][0];
    names.forEach(([id], k) => {
      buttons[k].setAttribute('aria-selected', String(id === tab));
      buttons[k].tabIndex = id === tab ? 0 : -1;
      byId(`panel-${id}`).hidden = id !== tab;
    });
    opened(tab);
  };
  store.listen((now, before) => now.tab !== before.tab && show());
  show();
}

async function start(): Promise<void> {
  const data = new Data();
  const { head } = data;
  document.title = head.title || head.file;
  byId('title').textContent = head.title || head.file;
  byId('subtitle').textContent = [head.file, head.cases > 1 ? `${head.cases} cases` : '', head.date.slice(0, 10)].filter(Boolean).join(' \u00b7 ');
  const initial = initialState(data);
  const store = new Store(initial, (s) => valid(data, initial, s), head.cases);
  const charts = head.charts?.length ? chartsPage(byId('panel-charts'), head.charts, head.kinds) : null;
  const pages: [string, string][] = [['map', head.cases === 1 ? 'Case' : 'Map'], ['charts', 'Charts'], ['scenario', 'Scenario'], ['about', 'About']];
  const parts: (() => void)[] = charts ? [charts] : [];
  theme(() => parts.forEach((redraw) => redraw()));
  aboutPage(byId('panel-about'), data);
  const names = pages.filter(([id]) => (id === 'map' ? head.cases > 0 : id === 'charts' ? charts : true));
  tabs(names, store, (tab) => tab === 'charts' && charts?.());
  if (head.cases > 0) cases(data, store, parts);
  await scenarioPage(byId('panel-scenario'), data);
}

// The map, the cases that are played, and what may be changed.
function cases(data: Data, store: Store, parts: (() => void)[]): void {
  const lack = data.head.wire === null ? 'The scenario in the file is of another version: the page shows what the file has, and simulates nothing.' : lacking(data.head.engine);
  if (lack) byId('case-part').append(el('p', { class: 'sentence', id: 'lacking' }, lack));
  let live: Live | null = null;
  let first!: () => void;
  const painted = new Promise<void>((resolve) => (first = resolve));
  // The engine waits until the map is on the screen.
  const pool = lack ? Promise.resolve(null) : painted.then(() => Pool.make(data)).catch((problem: unknown) => (complain(problem), null));
  const map = new MapPart(data, store, pool, (p, running) => live?.progress(p, running), (problem) => live?.refused(problem));
  const single = map.scales.length === 0;
  document.querySelector('main')!.classList.toggle('single', single);
  const play = new Cases(byId('case-part'), data, pool, store, (ref) => map.where(ref));
  if (!lack)
    live = new Live(byId('live-part'), store, !single, {
      describe: async (view) => {
        const made = await pool;
        if (!made) throw new Error('this page cannot simulate here');
        return made.ask<ViewText>(view, 'describe', [], true);
      },
      stop: () => map.stop(),
      command: () => map.command(),
      kind: async (view, index) => (await (await pool)!.ask<Results>(view, 'run', [Float64Array.of(single ? 0 : index)], true)).kinds[0],
      kindName: (kind) => data.head.kinds[kind].name,
    });
  parts.push(() => map.redraw(), () => play.redraw());
  let steps = 0;
  store.listen((now, before) => {
    // Of one case its change is shown beside it.
    if (single && now.changes !== before.changes) {
      const [own] = store.initial.cases;
      store.set({ cases: now.changes.length ? [{ index: own.index, view: now.changes }, own] : [own] }, true);
      return;
    }
    void map.update(now, before).catch(complain);
    if (!lack) play.update(now, before, now.cases !== before.cases && now.cases.length > 0 && ++steps > 0);
    if (now.changes !== before.changes || now.map !== before.map || Object.is(now.time, before.time)) live?.update();
  });
  void map
    .update(store.state, null)
    .catch(complain)
    .then(() => requestAnimationFrame(() => {
      document.body.dataset.painted = String(Math.round(performance.now()));
      setTimeout(first);
    }));
  if (!lack) {
    play.update(store.state, null, false);
    void live?.start().catch(complain);
  }
}

byId('reading').remove();
void whole.then(() => isCut() && complain(new Error('The page is not whole: its file was cut off.')));
window.addEventListener('error', (e) => complain(e.error ?? e.message));
window.addEventListener('unhandledrejection', (e) => complain(e.reason));
byId('problem-close').addEventListener('click', () => (byId('problem').hidden = true));
if (typeof DecompressionStream !== 'function')
  complain('This page needs a newer browser: Chrome or Edge 80, Firefox 113, Safari 16.4, or later.');
else void start().catch(complain);
