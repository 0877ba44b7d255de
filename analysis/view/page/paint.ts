// paint.ts - the colours of a layer: by outcome, by an answer, or by what differs from the file; and their legend.
import { gradient, hues, numberPixels, pixel } from './colours';
import { el, style } from './dom';
import type { Data } from './data';
import type { Answer } from './format';
import { differences, unknown, type Get, type Layer } from './layers';
import { label, numberText, tics, ticTexts } from './numbers';

export interface Entry {
  name: string;
  colour: string;
  count: number;
}

export interface Colouring {
  title: string;
  pixels: Get; // of case n of the layer; 0: nothing there
  entries: Entry[];
  of: number; // cases that the entries count
  bar: { low: number; high: number; unit: string } | null;
  number: Get | null; // what a curve draws
  note: string;
}

export const outcomeTitle = 'outcome';

function byWords(title: string, layer: Layer, get: Get, words: string[], colours: string[]): Colouring {
  const counts = new Array<number>(words.length).fill(0);
  for (let n = 0; n < layer.count; n++) if (layer.kinds[n] !== unknown) counts[get(n)]++;
  const table = colours.map(pixel);
  const entries = words.map((name, k) => ({ name, colour: colours[k], count: counts[k] })).filter((e) => e.count > 0);
  const of = entries.reduce((sum, e) => sum + e.count, 0);
  return { title, pixels: (n) => (layer.kinds[n] === unknown ? 0 : table[get(n)]), entries, of, bar: null, number: null, note: '' };
}

function byNumber(answer: Answer, layer: Layer, get: Get): Colouring {
  let low = Infinity;
  let high = -Infinity;
  let none = 0;
  for (let n = 0; n < layer.count; n++) {
    if (layer.kinds[n] === unknown) continue;
    const x = get(n);
    if (Number.isFinite(x)) {
      if (x < low) low = x;
      if (x > high) high = x;
    } else none++;
  }
  const empty = !(high >= low);
  const nothing = pixel(style('--no-number'));
  const factor = high > low ? 255 / (high - low) : 0;
  const entries = none > 0 ? [{ name: 'no number', colour: style('--no-number'), count: none }] : [];
  return {
    title: label(answer.name, answer.unit),
    pixels: (n) => {
      if (layer.kinds[n] === unknown) return 0;
      const x = get(n);
      return Number.isFinite(x) ? numberPixels[Math.round((x - low) * factor)] : nothing;
    },
    entries, of: layer.count, bar: empty ? null : { low, high, unit: answer.unit }, number: get, note: answer.text,
  };
}

export async function colouring(data: Data, layer: Layer, name: string): Promise<Colouring> {
  const { kinds, answers } = data.head;
  const answer = answers.find((a) => a.name === name);
  if (name === 'outcome' || !answer)
    return byWords(outcomeTitle, layer, (n) => layer.kinds[n], kinds.map((k) => k.name), kinds.map((k) => k.colour));
  const get = await layer.answer(answer);
  if (!get) throw new Error(`${name} is not carried by this page: stance view --answers ${name}`);
  if (answer.type !== 'code' || !answer.words) return byNumber(answer, layer, get);
  const words = [...answer.words, 'not simulated'];
  const colours = words.map((w, k) => kinds.find((x) => x.name === w)?.colour ?? (w === 'none' || k === words.length - 1 ? style('--no-number') : hues[k % hues.length]));
  const last = words.length - 1;
  return { ...byWords(answer.name, layer, (n) => { const k = get(n); return k >= 0 && k < last ? k : last; }, words, colours), note: answer.text };
}

export function differenceColouring(data: Data, file: Layer, now: Layer): Colouring {
  const found = differences(file, now);
  const { kinds } = data.head;
  const same = style('--same');
  const codes = [...found.counts.entries()].sort((a, b) => b[1] - a[1]);
  const table = new Uint32Array(256).fill(pixel(same));
  const entries = codes.map(([code, count], k) => {
    const colour = hues[k % hues.length];
    table[code] = pixel(colour);
    return { name: `${kinds[code >> 4].name} \u2192 ${kinds[code & 15].name}`, colour, count };
  });
  const differ = entries.reduce((sum, e) => sum + e.count, 0);
  entries.push({ name: 'as in the file', colour: same, count: found.compared - differ });
  return {
    title: 'from the file to here', pixels: (n) => (now.kinds[n] === unknown ? 0 : table[found.of[n]]), entries, of: found.compared, bar: null,
    number: null, note: found.compared === 0 ? 'the file has no outcome of these cases' : JSON.stringify(file.grid) === JSON.stringify(now.grid) ? '' : 'each case against the nearest one of the file',
  };
}

export function drawLegend(element: HTMLElement, c: Colouring): void {
  const parts: HTMLElement[] = [el('strong', {}, c.title)];
  if (c.bar) {
    const { low, high } = c.bar;
    const ramp = el('div', { class: 'ramp' });
    ramp.style.background = gradient('90deg');
    const scale = el('div', { class: 'ramp-tics' });
    const list = tics(low, high, 4);
    const texts = ticTexts(list);
    for (const [k, x] of list.entries()) {
      const tic = el('span', {}, texts[k]);
      tic.style.left = `${high > low ? (100 * (x - low)) / (high - low) : 50}%`;
      scale.append(tic);
    }
    parts.push(el('div', { class: 'bar', role: 'img', 'aria-label': `${c.title}: colours from ${numberText(low)} to ${numberText(high)} ${c.bar.unit}` }, ramp, scale));
  }
  for (const e of c.entries) {
    const swatch = el('i', { class: 'swatch' });
    swatch.style.background = e.colour;
    const share = c.of ? `${numberText((100 * e.count) / c.of, 4)} %` : '';
    parts.push(el('span', { class: 'entry', 'data-name': e.name, 'data-count': e.count }, swatch, `${e.name} `, el('small', {}, `${e.count} \u00b7 ${share}`)));
  }
  if (c.note) parts.push(el('small', { class: 'note' }, c.note));
  element.replaceChildren(...parts);
}
