// cases.ts - the cases that are played: each simulated in a worker, with what it is, whether it is the file's to the bit,
// and the command that reproduces it.
import { Courses } from './courses';
import type { Data } from './data';
import { hues } from './colours';
import { command, complain, el } from './dom';
import type { Play } from './engine';
import type { ViewText } from './format';
import { numberText, withUnit } from './numbers';
import { Player, reduced, type PlayedCase } from './player';
import type { Pool } from './pool';
import { sameCase, type CaseRef, type State, type Store, type View } from './state';
import { shellWord } from './wire';

type Run = { scene: ViewText } & Play;

export interface Badge {
  text: string;
  good: boolean | null; // null: neither
}

const most_rows = 3000;

export class Cases {
  private readonly runs = new Map<string, Promise<Run>>();
  private readonly list = el('div', { id: 'case-list' });
  private readonly player: Player;
  private readonly courses: Courses;
  private readonly stage = el('div', {});
  private shown: CaseRef[] = [];
  private turn = 0;

  constructor(
    part: HTMLElement,
    private readonly data: Data,
    private readonly pool: Promise<Pool | null>,
    private readonly store: Store,
    private readonly where: (ref: CaseRef) => string,
  ) {
    this.player = new Player((time, passing) => {
      this.courses.at(time);
      this.store.set({ time }, passing);
    });
    this.courses = new Courses((time) => this.player.go(time));
    this.stage.append(this.player.element, this.courses.element);
    this.stage.hidden = true;
    part.append(this.list, this.stage);
    this.list.append(this.hint());
    document.addEventListener('keydown', (e) => {
      const target = e.target instanceof HTMLElement ? e.target : null;
      if (target && /^(INPUT|SELECT|TEXTAREA|BUTTON|SUMMARY|A)$/.test(target.tagName)) return;
      if (!e.ctrlKey && !e.altKey && !e.metaKey && this.player.key(e.key)) e.preventDefault();
    });
  }

  private hint = (): HTMLElement =>
    el('div', { class: 'empty' }, el('p', {}, 'What happens at a place of the map?'),
      el('p', { class: 'muted' }, 'Click it: the case is simulated here, and played. With Shift it is added, to compare.'));

  // The run of a case, simulated once.
  run(ref: CaseRef): Promise<Run> {
    const key = JSON.stringify(ref);
    let found = this.runs.get(key);
    if (!found) {
      if (this.runs.size > 24) this.runs.delete([...this.runs.keys()][0]);
      found = this.simulate(ref);
      this.runs.set(key, found);
    }
    return found;
  }

  private async simulate(ref: CaseRef): Promise<Run> {
    const pool = await this.pool;
    if (!pool) throw new Error('this page cannot simulate here');
    // Of a file of one case the engine has a view of one case.
    const index = this.data.head.single && ref.index === this.data.head.index ? 0 : ref.index;
    const played = await pool.ask<Play>(ref.view, 'play', [index, most_rows], true);
    return { ...played, scene: await pool.ask<ViewText>(ref.view, 'describe', [], true) };
  }

  update(now: State, before: State | null, play: boolean): void {
    if (!before || now.time !== before.time) {
      this.player.at(now.time);
      this.courses.at(now.time);
    }
    const same = before && now.cases.length === this.shown.length && now.cases.every((c, k) => sameCase(c, this.shown[k]));
    if (same && before && now.beside === before.beside && now.changes === before.changes) return;
    this.shown = now.cases;
    void this.show(now, play).catch(complain);
  }

  redraw(): void {
    this.courses.draw();
    this.player.at(this.store.state.time);
  }

  private async show(now: State, play: boolean): Promise<void> {
    const turn = ++this.turn;
    const { cases } = now;
    if (!cases.length) {
      this.list.replaceChildren(this.hint());
      this.stage.hidden = true;
      this.player.show([], false);
      return;
    }
    const cards = cases.map((ref, k) => this.card(ref, k));
    this.list.replaceChildren(...cards, ...(cases.length > 1 ? [this.arrangement(now)] : []));
    const results = await Promise.allSettled(cases.map((ref) => this.run(ref)));
    if (turn !== this.turn) return;
    const played: PlayedCase[] = [];
    for (const [k, result] of results.entries()) {
      const card = cards[k];
      if (result.status === 'rejected') {
        card.append(el('p', { class: 'error badge bad' }, (result.reason as Error).message));
        continue;
      }
      const run = result.value;
      const badges = await this.badges(cases[k], run);
      if (turn !== this.turn) return;
      const answers = await this.answers(run);
      card.append(el('div', { class: 'row' }, el('b', { class: 'outcome' }, this.outcome(run)), ...badges.map((b) => el('span', { class: `badge ${b.good === null ? '' : b.good ? 'good' : 'bad'}` }, b.text))), answers);
      played.push({ name: `case ${cases[k].index}`, outcome: this.outcome(run), hue: hues[k % hues.length], ...run });
    }
    this.stage.hidden = played.length === 0;
    this.player.show(played, now.beside);
    this.courses.show(played);
    this.player.at(this.store.state.time);
    if (play && !reduced()) this.player.play(true);
  }

  private arrangement(now: State): HTMLElement {
    const one = (beside: boolean, text: string): HTMLElement =>
      el('button', { type: 'button', class: 'small', 'aria-pressed': String(now.beside === beside), onclick: () => this.store.set({ beside }) }, text);
    return el('div', { class: 'group', role: 'group', 'aria-label': 'Arrangement' }, one(false, 'one over the other'), one(true, 'side by side'));
  }

  private card(ref: CaseRef, k: number): HTMLElement {
    const { store } = this;
    const remove = (): void => store.set({ cases: store.state.cases.filter((c) => !sameCase(c, ref)) });
    const again = (): void => store.set({ cases: [...store.state.cases, { index: ref.index, view: store.state.changes }] });
    const { changes } = store.state;
    const changed = { index: ref.index, view: changes };
    const offer = changes.length > 0 && ref.view.length === 0 && !store.state.cases.some((c) => sameCase(c, changed));
    const text = this.commandOf(ref);
    const card = el('div', { class: 'case', 'data-case': ref.index },
      el('div', { class: 'row' },
        el('span', {}, el('b', {}, this.data.head.single ? 'the case of the file' : `case ${ref.index}`), ' ', el('small', {}, this.where(ref))),
        offer ? el('button', { type: 'button', class: 'small', onclick: again }, 'with the changes, too') : null,
        el('button', { type: 'button', class: 'small', 'aria-label': `Remove case ${ref.index}`, onclick: remove }, '\u00d7')),
      ...(text ? [el('details', {}, el('summary', { class: 'muted' }, 'command that reproduces this'), command(text))] : []));
    card.style.setProperty('--hue', store.state.cases.length > 1 ? hues[k % hues.length] : 'var(--line)');
    return card;
  }

  // Answers of the run, closed at first.
  private async answers(run: Run): Promise<HTMLElement> {
    const columns = (await this.pool)!.columns;
    const facts = columns.map((a, k) => {
      const x = run.text.answers[k];
      const text = x === null || x === undefined ? '-' : a.words ? a.words[x] : withUnit(numberText(x, 7), a.unit);
      return el('div', { title: a.text }, el('dt', {}, a.name), el('dd', {}, text));
    });
    return el('details', {}, el('summary', { class: 'muted' }, 'answers'), el('dl', { class: 'facts' }, ...facts));
  }

  private outcome = (run: Run): string => this.data.head.kinds[run.text.kind].name;

  commandOf(ref: CaseRef): string | null {
    const file = shellWord(this.data.head.command_file);
    const sets = ref.view.map((s) => ` --set ${shellWord(s)}`).join('');
    if (ref.view.some((s) => s.startsWith('sweep='))) return null; // of another map: its own command makes it
    return `stance replay ${file}${this.data.head.single ? '' : ` --case ${ref.index}`}${sets}`;
  }

  // Whether the run is the file's.
  private async badges(ref: CaseRef, run: Run): Promise<Badge[]> {
    const { data } = this;
    const { head } = data;
    if (ref.view.length) return [{ text: sweptAnew(ref.view) ? 'a case computed in this page' : 'parameters changed', good: null }];
    const row = head.single ? 0 : ref.index;
    const kind = (await data.block('kind'))[row];
    if (head.kinds[kind].name === 'pending') return [{ text: 'not in the file yet', good: null }];
    if (data.has('inferred') && (await data.block('inferred'))[row]) return [{ text: 'not simulated in the file (inferred)', good: null }];
    if (data.has('number') && (await data.block('number'))[row] !== head.number) return [{ text: 'of an earlier scenario of the file', good: null }];
    if (head.checksums && (await data.block('checksum'))[row] === run.text.checksum >>> 0) return [{ text: 'identical to the file', good: true }];
    const differ: string[] = [];
    if (kind !== run.text.kind) differ.push(`outcome (file ${head.kinds[kind].name}, here ${head.kinds[run.text.kind]?.name})`);
    const columns = (await this.pool)!.columns;
    for (const a of head.answers) {
      const k = columns.findIndex((c) => c.name === a.name);
      if (!a.block || k < 0 || a.name === 'outcome') continue;
      const there = (await data.block(a.block))[row];
      const here = run.text.answers[k] ?? NaN;
      const same = a.type === 'code' ? there === here : Object.is(Math.fround(here), there) || (Number.isNaN(here) && Number.isNaN(there)) || Math.fround(here) === there;
      if (same) continue;
      const say = (x: number): string => (a.words ? (a.words[x] ?? '-') : numberText(x, 7));
      differ.push(`${a.name} (file ${say(there)}, here ${say(here)})`);
    }
    if (!head.checksums) return [differ.length ? { text: `differs: ${differ.join(', ')}`, good: false } : { text: 'as in the file, as far as it tells', good: true }];
    return [{ text: differ.length ? `differs: ${differ.join(', ')}` : 'differs beyond 7 digits', good: false }];
  }
}

export const sweptAnew = (view: View): boolean => view.some((s) => s.startsWith('sweep='));
