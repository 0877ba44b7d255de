// pages.ts - the pages beside the map: the scenario with what the file says of itself, and what this page is made of.
import { command, copy, download, el } from './dom';
import type { Data } from './data';
import { numberText } from './numbers';
import { shellWord } from './wire';

declare const LICENCES: string; // of what is inlined, from build.mjs

const row = (...cells: string[]): HTMLElement => el('tr', {}, ...cells.map((c, k) => el(k ? 'td' : 'th', k ? {} : { scope: 'row' }, c)));

export async function scenarioPage(part: HTMLElement, data: Data): Promise<void> {
  const { head } = data;
  const parts: HTMLElement[] = [el('h2', {}, head.title)];
  if (head.cases > 0) {
    const kinds = await data.block('kind');
    const counts = new Array<number>(head.kinds.length).fill(0);
    for (const k of kinds) counts[k]++;
    const rows = head.kinds.map((k, i) => ({ name: k.name, count: counts[i] })).filter((r) => r.count > 0);
    parts.push(el('table', { 'aria-label': 'Cases by outcome' },
      el('tbody', {}, ...rows.map((r) => el('tr', {}, el('th', { scope: 'row' }, r.name), el('td', { class: 'number' }, String(r.count)), el('td', { class: 'number' }, `${numberText((100 * r.count) / head.cases, 4)} %`))))));
  }
  parts.push(el('table', { 'aria-label': 'Provenance' }, el('tbody', {},
    row('file', head.file), ...(head.date ? [row('computed', `${head.date}, by stance ${head.file_program} (${head.file_revision})`)] : []),
    row('this page', `by stance ${head.program} (${head.revision})`), ...(head.cases > 0 ? [row('cases', head.single ? `one, place ${head.index} of its sweep` : String(head.cases))] : []),
    ...(head.recorded.length ? [row('with trajectories', head.recorded.slice(0, 20).join(', ') + (head.recorded.length > 20 ? ', ...' : ''))] : []))));
  if (head.left_out.length)
    parts.push(el('h2', {}, 'What the page does not carry'), el('p', {}, `Answers left out for their size: ${head.left_out.join(', ')}. To carry one of them:`),
      command(`stance view ${shellWord(head.command_file)} --answers ${head.left_out[0]}`));
  const button: HTMLButtonElement = el('button', { type: 'button', onclick: () => void copy(head.scenario, button) }, 'copy');
  if (head.scenario) parts.push(el('h2', {}, 'Scenario'), el('div', { class: 'row' }, button,
    el('button', { type: 'button', onclick: () => download(fileName(data), head.scenario) }, `save as ${fileName(data)}`)), el('pre', { tabindex: '0' }, head.scenario));
  part.replaceChildren(...parts);
}

export const fileName = (data: Data): string => data.head.file.replace(/^.*\//, '').replace(/\.h5$/, '') + '.yaml';

export function aboutPage(part: HTMLElement, data: Data): void {
  const { head } = data;
  part.replaceChildren(
    el('h2', {}, `stance ${head.program} (${head.revision})`),
    el('p', {}, 'This page holds the results of a study and the engine that computed them, as WebAssembly: what is played is simulated here, to the same bits. It needs no server and no network.'),
    el('h2', {}, 'Keys'),
    el('table', {}, el('tbody', {},
      row('arrows', 'move over the map, with Shift ten cells at a time'), row('Enter', 'play the case under the cursor; with Shift add it'),
      row('+ \u2212 0', 'zoom in and out about the cursor; show all'), row('Space', 'play and pause'), row(', .', 'one step back, one step on'))),
    el('h2', {}, 'Licences'),
    el('p', {}, 'stance is free software under the GNU General Public License, version 3. What else is in this page:'),
    el('pre', { tabindex: '0' }, LICENCES));
}
