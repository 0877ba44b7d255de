// view.mjs - pages of files of many kinds in a browser: clicks, plays, changes a parameter, and reads what a user reads.
// Speaks TAP. Usage: node view.mjs FOLDER, with the pages that whole_view.sh has made in it.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { open } from './web.mjs';

const folder = process.argv[2];
const only = process.argv[3];
const at = (name) => join(folder, name);
const checks = [];
const check = (name, f) => checks.push([name, f]);
const assert = (good, text) => {
  if (!good) throw new Error(text);
};
const same = (a, b, what) => assert(a === b, `${what}: ${JSON.stringify(a)} instead of ${JSON.stringify(b)}`);
const shift = 8;

// With a page, closed in the end; no check leaves an error on the console or asks the network.
async function on(file, options, f) {
  const page = await open(at(file), options);
  try {
    await f(page);
    if (!options.mistakes) same(page.errors.join('; '), '', 'errors of the page');
    same(page.requests.join('; '), '', 'requests to the network');
  } catch (problem) {
    await page.screenshot(at(`failed-${file}.png`)).catch(() => {});
    throw problem;
  } finally {
    await page.close();
  }
}
const painted = `document.body.dataset.painted`;
const played = `!document.querySelector('#case-list')?.parentElement.querySelector('#figure')?.closest('[hidden]') && document.querySelector('#case-list .badge')`;
const badges = `[...document.querySelectorAll('#case-list .badge')].map((b) => b.textContent).join('|')`;
const count = (name) => `Number(document.querySelector('#legend [data-name="${name}"]')?.dataset.count ?? 0)`;
const computed = `document.querySelector('#progress')?.dataset.running === 'false'`;
const fields = `document.querySelector('#fields .field')`;
const field = (path) => `[id="field-${path}"]`;
const choose = (label) => `[...document.querySelectorAll('#show button, .group button')].find((b) => b.textContent === '${label}').click()`;
const head = (file) => JSON.parse(/<script type="application\/json" id="head">([^]*?)<\/script>/.exec(readFileSync(at(file), 'utf8'))[1]);
// A copy of a page with another head, or with other text.
const changed = (file, to, edit) => {
  const text = readFileSync(at(file), 'utf8');
  writeFileSync(at(to), edit(text));
};
const withHead = (file, to, edit) =>
  changed(file, to, (text) => text.replace(/(<script type="application\/json" id="head">)([^]*?)(<\/script>)/, (_, a, json, z) => a + JSON.stringify(edit(JSON.parse(json))).replace(/</g, '\\u003c') + z));

check('a map: counts, colours, and the case under the pointer', () =>
  on('map.html', {}, async (p) => {
    await p.until(painted);
    const h = head('map.html');
    same(await p.evaluate(`${count('stabilised')} + ${count('fell')}`), h.cases, 'cases in the legend');
    assert(await p.evaluate(`${count('stabilised')} > 100 && ${count('fell')} > 100`), 'both outcomes are there');
    same((await p.pixel('#map', 0.95, 0.95)).join(), '243,187,76', 'colour of a fall');
    same((await p.pixel('#map', 0.5, 0.5)).join(), '0,90,146', 'colour of a recovery');
    await p.move(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(`document.querySelector('#readout').innerText.includes('stabilised')`);
    const told = await p.text('#readout');
    for (const word of ['initial.offset.theta = ', 'rad/s', 'settle_time', 'friction_used']) assert(told.includes(word), `the readout says ${word}: ${told}`);
  }));

check('how far a number may go before the case that is played ends otherwise', () =>
  on('map.html', { motion: false }, async (p) => {
    const row = '[data-path="controller.torque_limit"]';
    await p.until(fields);
    await p.evaluate(`document.querySelector('${row} button').click()`);
    same(await p.text(`${row} .critical`), 'of which case? Click one.', 'without a case');
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    await p.evaluate(`document.querySelector('${row} button').click()`);
    await p.until(`document.querySelector('${row} .critical').textContent.includes('down to')`);
    const told = await p.text(`${row} .critical`);
    const [, kept, then] = /is stabilised up to 20 and perhaps beyond, down to ([\d.]+) \(then (\w+)\)$/.exec(told) ?? [];
    const found = JSON.parse(readFileSync(at('critical.json'), 'utf8')).rows[0];
    assert(then === found.outcome_then && Number(kept) <= found.kept + 1e-4 && Number(kept) >= found.lost - 1e-4, `${told}: ${JSON.stringify(found)}`);
    // Of a mass the design stays.
    const mass = '[data-path="robot.trunk_mass"]';
    await p.evaluate(`document.querySelector('${mass} button').click()`);
    await p.until(`/up to/.test(document.querySelector('${mass} .critical').textContent)`);
  }));

check('a click plays the case: identical to the file, courses, command', () =>
  on('map.html', { motion: false }, async (p) => {
    await p.until(painted);
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    same(await p.evaluate(badges), 'identical to the file', 'badge');
    assert(/stance replay \S*map.h5 --case \d+/.test(await p.evaluate(`document.querySelector('#case-list code').textContent`)), 'the command');
    same(await p.evaluate(`document.querySelectorAll('.course canvas').length`), 3, 'courses');
    await p.evaluate(`[...document.querySelectorAll('.courses .group button')].find((b) => b.textContent === 'energy').click()`);
    same(await p.evaluate(`document.querySelectorAll('.course canvas').length`), 4, 'courses with the energy');
    assert(/^0\.000 \/ /.test(await p.text('#clock')), 'with reduced motion it waits');
    const before = await p.evaluate(`document.querySelector('#figure').getAttribute('aria-label')`);
    await p.key('.');
    assert(!/^0\.000/.test(await p.text('#clock')), 'one step on');
    for (let k = 0; k < 200; k++) await p.key('.');
    assert((await p.evaluate(`document.querySelector('#figure').getAttribute('aria-label')`)) !== before, 'the figure has moved');
    await p.key(',');
    const [x, y] = await p.spot('.course .u-over', 0.8, 0.5);
    await p.drag(x - 60, y, x, y);
    const [time, end] = (await p.text('#clock')).match(/[\d.]+/g).map(Number);
    assert(Math.abs(time / end - 0.8) < 0.1, `dragging in a course moves the time to ${time} of ${end}`);
    await p.key(' ');
    await p.until(`document.querySelector('#play').textContent === 'pause'`);
    await p.key(' ');
    await p.until(`document.querySelector('#play').textContent === 'play'`);
    assert(await p.evaluate(`location.hash.includes('case=')`), 'the address names the case');
  }));

check('of two cases the longer one is stepped through', () =>
  on('map.html', { motion: false, hash: '#case=0&case=840' }, async (p) => {
    await p.until(`document.querySelectorAll('#case-list .badge').length === 2`);
    await p.evaluate(`document.querySelector('#scrub').max *= 0.95; document.querySelector('#scrub').value = document.querySelector('#scrub').max; document.querySelector('#scrub').dispatchEvent(new Event('input'))`);
    const before = parseFloat(await p.text('#clock'));
    for (let k = 0; k < 3; k++) await p.key('.');
    assert(parseFloat(await p.text('#clock')) > before, `from ${before} to ${await p.text('#clock')}`);
    assert(!/undefined/.test(await p.evaluate(`document.querySelector('#case-list').textContent`)), 'answers have their words');
  }));

check('a case plays by itself, slowly if asked', () =>
  on('map.html', {}, async (p) => {
    await p.until(painted);
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    await p.until(`parseFloat(document.querySelector('#clock').textContent) > 0.05`);
    await p.set('.transport select', '0.02');
    // By the page's own frames, however far apart they are: at a fiftieth of the speed.
    const [passed, seconds] = await p.evaluate(`new Promise((done) => {
      const clock = () => parseFloat(document.querySelector('#clock').textContent);
      let begin;
      const frame = (now) => {
        begin ??= [clock(), now];
        if (clock() - begin[0] >= 0.02) done([clock() - begin[0], (now - begin[1]) / 1000]);
        else requestAnimationFrame(frame);
      };
      requestAnimationFrame(() => requestAnimationFrame(frame));
    })`);
    assert(passed < 0.1 * seconds, `in ${seconds} s ${passed} s at a fiftieth of the speed`);
  }));

check('only keys: arrows, Enter, and a second case beside the first', () =>
  on('map.html', { motion: false }, async (p) => {
    await p.until(painted);
    await p.evaluate(`document.querySelector('#map').focus()`);
    await p.key('ArrowLeft');
    await p.key('ArrowLeft');
    await p.until(`document.querySelector('#readout').innerText.includes('case')`);
    const first = await p.text('#readout');
    await p.key('ArrowRight');
    await p.until(`!document.querySelector('#readout').innerText.startsWith(${JSON.stringify(first.slice(0, 40))})`);
    await p.key('Enter');
    await p.until(played);
    await p.key('ArrowUp', shift);
    await p.key('Enter', shift);
    await p.until(`document.querySelectorAll('#case-list .badge').length === 2`);
    same(await p.evaluate(badges), 'identical to the file|identical to the file', 'both badges');
    await p.evaluate(choose('side by side'));
    await p.until(`location.hash.includes('beside=1')`);
    await p.press('#case-list .case button');
    await p.until(`document.querySelectorAll('#case-list .case').length === 1`);
    await p.evaluate(`history.back()`);
    await p.until(`document.querySelectorAll('#case-list .case').length === 2`);
  }));

check('an address shows the same again', async () => {
  let hash = '';
  let clock = '';
  await on('map.html', { motion: false }, async (p) => {
    await p.until(painted);
    await p.set('#colour', 'settle_time');
    await p.drag(...(await p.spot('#map', 0.2, 0.2)), ...(await p.spot('#map', 0.7, 0.8)));
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    await p.set('#scrub', '0.5');
    await p.until(`/zoom=.*t=0.5/.test(location.hash)`);
    hash = await p.evaluate('location.hash');
    clock = await p.text('#clock');
  });
  await on('map.html', { motion: false, hash }, async (p) => {
    await p.until(played);
    await p.until(`document.querySelector('#clock').innerText === ${JSON.stringify(clock)}`);
    same(await p.evaluate('location.hash'), hash, 'address');
    assert((await p.text('#legend')).startsWith('settle_time'), 'the colour');
    await p.press('#zoom-all');
    await p.until(`!location.hash.includes('zoom')`);
  });
});

check('wheel and pan stay within the map', () =>
  on('map.html', {}, async (p) => {
    await p.until(painted);
    const [x, y] = await p.spot('#map', 0.5, 0.5);
    for (let k = 0; k < 3; k++) await p.call('Input.dispatchMouseEvent', { type: 'mouseWheel', x, y, deltaX: 0, deltaY: -200 });
    const zoom = () => p.evaluate(`location.hash.match(/zoom=([^&]*)/)?.[1].split(',').map(Number) ?? []`);
    // The address follows the last turn of the wheel after a while.
    await p.until(`location.hash.match(/zoom=([^&]*)/)?.[1].split(',').reduce((a, v, k) => a + [-1, 1, 0, 0][k] * v, 0) < 41 * Math.exp(-0.85)`);
    const before = await zoom();
    await p.drag(x, y, x - 50, y, shift);
    await p.until(`Number(location.hash.match(/zoom=([^,]*)/)?.[1]) > ${before[0]}`);
    const after = await zoom();
    assert(after[0] > before[0] && Math.abs(after[1] - after[0] - before[1] + before[0]) < 1e-3, `panned from ${before} to ${after}`);
    for (let k = 0; k < 40; k++) await p.call('Input.dispatchMouseEvent', { type: 'mouseWheel', x, y, deltaX: 0, deltaY: 300 });
    await p.until(`!location.hash.includes('zoom')`);
  }));

check('live: friction changes the map; the difference is counted; the command computes it', () =>
  on('map.html', { motion: false }, async (p) => {
    await p.until(fields);
    await p.set(field('ground.friction'), '0.15');
    await p.until(computed);
    const here = await p.evaluate(count('stabilised'));
    assert(/^\d+ of \d+ cases simulated, [\d.]+ s: done$/.test(await p.text('#progress')), await p.text('#progress'));
    await p.evaluate(choose('difference'));
    await p.until(`document.querySelector('#legend').innerText.includes('\\u2192')`);
    assert((await p.evaluate(count('fell \u2192 stabilised'))) > 50, 'on this floor more recover');
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    same(await p.evaluate(badges), 'a case computed in this page', 'badge');
    const sets = await p.evaluate(`[...document.querySelectorAll('#live-part code')].map((c) => c.textContent).find((t) => t.startsWith('stance run'))`);
    writeFileSync(at('command.txt'), `${sets}\n${here}\n`);
    assert(await p.evaluate(`location.hash.includes('set=ground.friction=0.15')`), 'the address has the change');
    await p.press('.change button');
    await p.until(`!location.hash.includes('set=') && document.querySelector('#show').hidden`);
  }));

check('live: every case simulated is the file again, answer for answer', () =>
  on('map.html', { hash: '#map=0,all' }, async (p) => {
    await p.until(computed);
    await p.evaluate(choose('difference'));
    await p.until(`document.querySelector('#legend').innerText.includes('as in the file')`);
    same(await p.evaluate(count('as in the file')), head('map.html').cases, 'cases as in the file');
    await p.move(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(`document.querySelector('#readout').innerText.includes('friction_used')`);
    const here = await p.text('#readout');
    await p.evaluate(choose('file'));
    await p.until(`!document.querySelector('#legend').innerText.includes('as in the file')`);
    await p.move(...(await p.spot('#map', 0.51, 0.9)));
    await p.until(`![${JSON.stringify(here)}, ''].includes(document.querySelector('#readout').innerText)`);
    await p.move(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(`document.querySelector('#readout').innerText === ${JSON.stringify(here)}`);
  }));

check('live: two fields within a moment are two changes', () =>
  on('map.html', {}, async (p) => {
    await p.until(fields);
    await p.set(field('ground.friction'), '0.3');
    await p.set(field('controller.torque_limit'), '7');
    await p.until(`location.hash.includes('set=ground.friction=0.3&set=controller.torque_limit=7')`);
  }));

check('live: a map of what is in sight, stopped and started', () =>
  on('map.html', { hash: '#zoom=5,15,5,15' }, async (p) => {
    await p.until(fields);
    await p.press('#compute');
    await p.until(computed);
    assert(/map=64,refined,5,15,5,15/.test(await p.evaluate('location.hash')), 'the window is in the address');
    same(await p.evaluate(`document.querySelector('#map').dataset.cases`), '4096', 'cases of the window');
    await p.evaluate(`document.querySelector('#cells').value = '256'; document.querySelector('#cells').dispatchEvent(new Event('change'))`);
    await p.until(`document.querySelector('#progress').dataset.running === 'true'`);
    await p.press('#stop');
    await p.until(computed);
    assert((await p.text('#progress')).endsWith(': stopped'), await p.text('#progress'));
    await p.press('#compute');
    await p.until(`document.querySelector('#progress').dataset.running === 'true'`);
  }));

check('live: what the scenario does not admit is said at its field', () =>
  on('map.html', {}, async (p) => {
    await p.until(fields);
    await p.set(field('ground.friction'), '99');
    await p.until(`document.querySelector('[data-path="ground.friction"] .error').innerText.includes('10')`);
    assert((await p.text('#legend')).includes('stabilised'), 'the map stays');
    await p.set(field('ground.friction'), '0.8');
    await p.until(`document.querySelector('[data-path="ground.friction"] .error').innerText === '' && !location.hash.includes('set')`);
  }));

check('live: another mass keeps the controller; a controller without a design says so', () =>
  on('map.html', {}, async (p) => {
    await p.until(fields);
    await p.set('#search', 'trunk_mass');
    await p.set(field('robot.trunk_mass'), '1.9');
    await p.until(`document.querySelector('#changes').innerText.includes('the controller stays the one designed for robot.trunk_mass = 1.8')`);
    await p.until(computed);
    // Taken back, the design would have to be made anew.
    await p.evaluate(`document.querySelector('#changes button[aria-label="Take back controller.model.trunk_mass"]').click()`);
    await p.until(`[...document.querySelectorAll('#live-part .error')].some((e) => !e.hidden && /design/.test(e.innerText))`);
  }));

check('a case with changes beside the file\'s', () =>
  on('map.html', { motion: false, hash: '#set=controller.torque_limit=20&map=32,refined' }, async (p) => {
    await p.until(computed);
    await p.evaluate(choose('file'));
    await p.click(...(await p.spot('#map', 0.9, 0.9)));
    await p.until(played);
    await p.evaluate(`[...document.querySelectorAll('#case-list button')].find((b) => b.textContent === 'with the changes, too').click()`);
    await p.until(`document.querySelectorAll('#case-list .badge').length === 2`);
    same(await p.evaluate(badges), 'identical to the file|parameters changed', 'badges');
    const text = await p.evaluate(`[...document.querySelectorAll('#case-list code')].at(-1).textContent`);
    assert(text.includes('--set controller.torque_limit=20'), text);
  }));

check('a refined map says what is inferred', () =>
  on('refined.html', { motion: false }, async (p) => {
    await p.until(painted);
    await p.click(...(await p.spot('#map', 0.98, 0.98)));
    await p.until(played);
    assert((await p.text('#readout')).includes('inferred, not simulated'), await p.text('#readout'));
    same(await p.evaluate(badges), 'not simulated in the file (inferred)', 'badge');
  }));

check('five axes: any two across, sliders for the others, a curve of one', () =>
  on('axes.html', {}, async (p) => {
    await p.until(painted);
    same(await p.evaluate(`document.querySelectorAll('#sliders input').length`), 3, 'sliders');
    await p.set('#x', 'ground.restitution');
    await p.set('#y', 'initial.state.z');
    await p.until(`[...document.querySelectorAll('#sliders label')].map((l) => l.textContent).join() === 'ground.friction,initial.state.vx,initial.state.vz'`);
    const before = await p.text('#sliders output');
    await p.set('#sliders input', '1');
    assert((await p.text('#sliders output')) !== before, 'the slider says its value');
    await p.set('#y', '');
    await p.set('#colour', 'end_time');
    await p.until(`document.querySelector('#map').getAttribute('aria-label').startsWith('Map of end_time')`);
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    same(await p.evaluate(badges), 'identical to the file', 'badge');
  }));

check('a sample: points over two of its paths, simulated as in the file', () =>
  on('sample.html', { motion: false }, async (p) => {
    await p.until(painted);
    const options = await p.evaluate(`[...document.querySelector('#x').options].map((o) => o.value)`);
    assert(options.includes('ground.friction') && options.includes('controller.sample_time'), options.join());
    await p.evaluate(`document.querySelector('#map').focus()`);
    for (const key of ['ArrowRight', 'ArrowRight', 'ArrowUp', 'Enter']) await p.key(key);
    await p.until(played);
    same(await p.evaluate(badges), 'identical to the file', 'badge');
    await p.set(field('controller.noise'), '0.5');
    await p.until(computed);
    same(await p.evaluate(`document.querySelector('#map').dataset.computed`), 'true', 'computed');
  }));

check('a file of two scenarios: each case is held against its own', () =>
  on('scenarios.html', { motion: false, hash: '#case=0' }, async (p) => {
    await p.until(played);
    same(await p.evaluate(badges), 'of an earlier scenario of the file', 'badge');
    await p.evaluate(`location.hash = '#case=' + ${head('scenarios.html').cases - 1}`);
    await p.until(`${badges} === 'identical to the file'`);
  }));

check('a file without outcomes differs in none of them', () =>
  on('bare.html', { hash: '#map=0,all&show=difference' }, async (p) => {
    await p.until(computed);
    await p.until(`document.querySelector('#legend').innerText.includes('the file has no outcome')`);
  }));

check('of a comparison of methods all but event-driven is simulated', () =>
  on('methods.html', { motion: false, hash: '#case=0&case=1&case=2' }, async (p) => {
    await p.until(`document.querySelectorAll('#case-list .badge').length === 3`);
    same(await p.evaluate(badges), 'identical to the file|a page cannot simulate by event-driven, stance does|identical to the file', 'badges');
  }));

check('axes of the least numbers, and of all but equal ones', () =>
  on('tiny.html', { motion: false, hash: '#zoom=0.5,0.502,1,1.002' }, async (p) => {
    await p.until(painted);
    await p.press('#zoom-all');
    await p.until(`!location.hash.includes('zoom')`);
  }));

check('an axis of whole numbers is computed at them', () =>
  on('delays.html', {}, async (p) => {
    await p.until(fields);
    await p.set(field('ground.friction'), '0.5');
    await p.until(computed);
    same(await p.evaluate(`document.querySelector('#map').dataset.cases`), String(64 * 3), 'cases');
  }));

check('words of axes with several paths, and `none`, stand in what is computed', () =>
  on('pairs.html', { hash: '#x=initial.offset.q1&y=&map=32,all&set=ground.friction=0.7' }, async (p) => {
    await p.until(computed);
    const command = await p.evaluate(`document.querySelector('#live-part .command code').textContent`);
    assert(command.includes('--set method.name=implicit --set method.step=0.002 --set controller.torque_limit=none'), command);
    await p.set('#y', 'method.name');
    await p.until(`document.querySelector('#live-part .command code')?.textContent.includes('values: [[implicit, 0.002], [lagrange, 0.001]]')`);
    await p.until(`${computed} && document.querySelector('#map').dataset.cases === '64'`);
  }));

check('one case: it plays, and its changes stand beside it', () =>
  on('single.html', { motion: false }, async (p) => {
    await p.until(played);
    same(await p.evaluate(badges), 'identical to the file', 'badge');
    await p.until(fields);
    await p.set(field('controller.torque_limit'), '5');
    await p.until(`document.querySelectorAll('#case-list .badge').length === 2`);
    same(await p.evaluate(badges), 'parameters changed|identical to the file', 'badges');
    await p.until(`location.hash.includes('set=')`);
    await p.call('Page.reload');
    await p.until(`${badges} === 'parameters changed|identical to the file'`);
  }));

check('a mechanism with springs: identical, forces and no torques', () =>
  on('mechanism.html', { motion: false }, async (p) => {
    await p.until(painted);
    await p.click(...(await p.spot('#map', 0.5, 0.3)));
    await p.until(played);
    same(await p.evaluate(badges), 'identical to the file', 'badge');
    same(await p.evaluate(`[...document.querySelectorAll('.course')].map((c) => c.dataset.course).join()`), 'coordinates,forces', 'courses');
  }));

check('a walker: followed along the ground, its footfalls told; answers of steps; another slope', () =>
  on('walker.html', { motion: false }, async (p) => {
    await p.until(painted);
    const h = head('walker.html');
    same(await p.evaluate(`${count('walks')} + ${count('fell')}`), h.cases, 'cases in the legend');
    same((await p.pixel('#map', 0.5, 0.7)).join(), '45,184,124', 'colour of what walks');
    await p.click(...(await p.spot('#map', 0.5, 0.7)));
    await p.until(played);
    await p.click(...(await p.spot('#map', 0.1, 0.1)), shift);
    await p.until(`document.querySelectorAll('#case-list .badge').length === 2`);
    same(await p.evaluate(`[...document.querySelectorAll('#case-list .outcome')].map((x) => x.textContent).join()`), 'walks,fell', 'outcomes');
    same(await p.evaluate(badges), 'identical to the file|identical to the file', 'badges');
    const answers = await p.evaluate(`document.querySelector('#case-list dl').textContent`);
    for (const word of ['walked_steps1', 'step_time0.66', 'step_length0.27', 'gait_period1']) assert(answers.includes(word), `${word}: ${answers}`);
    // Metres from where it began it is in the middle still.
    await p.evaluate(`document.querySelector('#case-list .case:nth-of-type(2) button[aria-label^=Remove]').click()`);
    await p.until(`document.querySelectorAll('#case-list .badge').length === 1`);
    await p.set('#scrub', '7');
    await p.until(`/at 7.000 s: x [23].*, 1\\d footfalls/.test(document.querySelector('#figure').getAttribute('aria-label'))`);
    const legs = await p.evaluate(`(() => { const c = document.querySelector('#figure'); const w = Math.round(c.width / 3);
      const d = c.getContext('2d').getImageData(w, c.height / 4, w, c.height / 2).data; const found = [0, 0];
      for (let i = 0; i < d.length; i += 4) { if (d[i] === 0 && d[i + 1] === 114) found[0]++; if (d[i] === 213 && d[i + 1] === 94) found[1]++; } return found; })()`);
    assert(legs[0] > 50 && legs[1] > 50, `pixels of two legs in the middle: ${legs}`);
    await p.set('#colour', 'step_length');
    await p.until(`document.querySelector('#legend').innerText.startsWith('step_length (m)')`);
    await p.set('#colour', 'outcome');
    await p.evaluate(`location.hash = '#set=ground.slope=0.03&map=9,refined'`);
    await p.until(`${computed} && document.querySelector('#map').dataset.computed === 'true' && ${count('walks')} > 5`);
    const command = await p.evaluate(`document.querySelector('#live-part .command code').textContent`);
    assert(command.includes('--set ground.slope=0.03'), command);
  }));

check('a law of one\'s own plays; its parameters are changed like others', () =>
  on('law.html', { motion: false }, async (p) => {
    await p.until(played);
    same(await p.evaluate(badges), 'identical to the file', 'badge');
    await p.until(fields);
    await p.set(field('controller.stiffness'), '30');
    await p.until(`document.querySelectorAll('#case-list .badge').length === 2`);
    same(await p.evaluate(badges), 'parameters changed|identical to the file', 'badges');
  }));

check('a case that is not what the file says is found out', async () => {
  withHead('single.html', 'other.html', (h) => ({ ...h, wire: h.wire.replace('12:torque_limits2:10', '12:torque_limits1:5') }));
  await on('other.html', { motion: false }, async (p) => {
    await p.until(played);
    assert(/^differs: .*\(file .*, here .*\)/.test(await p.evaluate(badges)), await p.evaluate(badges));
  });
});

check('text with markup stays text', async () => {
  const evil = `<img src=x onerror="window.hacked=1"><script>window.hacked=1</script>`;
  withHead('map.html', 'evil.html', (h) => ({ ...h, title: evil, file: evil, scenario: evil, command_file: `x'; ${evil}`,
    axes: h.axes.map((a, k) => (k ? a : { ...a, path: evil, text: evil, unit: evil })) }));
  await on('evil.html', { motion: false }, async (p) => {
    await p.until(painted);
    await p.click(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    await p.evaluate(`document.querySelector('#tab-scenario').click()`);
    same(await p.evaluate(`String(window.hacked) + document.querySelectorAll('img').length`), 'undefined0', 'what ran');
    same(await p.text('#title'), evil, 'title');
  });
});

check('a browser without vectors, and one without streams, get a sentence', async () => {
  await on('map.html', { before: `WebAssembly.validate = () => false` }, async (p) => {
    await p.until(`document.querySelector('#lacking')`);
    assert((await p.text('#lacking')).includes('128-bit vectors'), await p.text('#lacking'));
    assert((await p.text('#legend')).includes('stabilised'), 'the map is there');
  });
  await on('map.html', { before: `delete window.DecompressionStream`, mistakes: true }, async (p) => {
    await p.until(`document.querySelector('#problem-text').innerText.includes('newer browser')`);
  });
});

check('a damaged page says so', async () => {
  changed('map.html', 'damaged.html', (text) => text.replace(/(id="block-kind">)([^<]{40})/, (_, a, b) => a + b.split('').reverse().join('')));
  await on('damaged.html', { mistakes: true }, (p) => p.until(`document.querySelector('#problem-text').innerText.includes('damaged')`));
});

check('a page that is cut off says so', async () => {
  for (const [name, part] of [['in its script', 'the page carries no data'], ['behind it', 'id="block-checksum"']]) {
    changed('map.html', 'cut.html', (text) => text.slice(0, text.indexOf(part) + 100));
    await on('cut.html', { mistakes: true }, async (p) =>
      p.until(`(document.querySelector('#reading') ?? document.querySelector('#problem-text')).innerText.includes('file ${name === 'behind it' ? 'was cut off' : 'is not whole'}')`));
  }
  await on('map.html', {}, (p) => p.until(`${painted} && !document.querySelector('#reading')`));
});

check('an address of nonsense shows the map', () =>
  on('map.html', { hash: '#set=sweep.grid[0].count=3&zoom=1e17,1.0000000000000002e17,0,1&x=no&y=%ZZ&at=1,2,3,4&zoom=NaN,1,2,3&case=9e99&case=3;[1]&set=&t=-4&map=-3,x&colour=no&tab=none' }, async (p) => {
    await p.until(painted);
    assert((await p.text('#legend')).includes('stabilised'), 'the map is there');
  }));

check('charts alone: curves with error bars, logarithmic axes', async () => {
  withHead('map.html', 'charts.html', (h) => ({ ...h, cases: 0, axes: [], answers: [], blocks: {}, charts: [{
    title: 'Accuracy', text: 'against cost', x: { label: 'cost', unit: 's', log: true }, y: { label: 'error', unit: 'm', log: true },
    series: [{ name: 'midpoint', x: [1, 10, 100], y: [1e-2, 1e-4, 1e-6], low: [5e-3, 5e-5, 5e-7], high: [2e-2, 2e-4, 2e-6], lines: true }, { name: 'implicit', x: [1, 20, 0], y: [1e-1, null, 1e-3], lines: false }] }] }));
  await on('charts.html', {}, async (p) => {
    await p.until(`document.querySelector('#panel-charts canvas')`);
    assert((await p.text('#panel-charts')).includes('midpoint'), 'legend');
    same(await p.text('#tabs'), 'Charts\nScenario\nAbout'.replace(/\n/g, (await p.text('#tabs')).includes('\n') ? '\n' : ''), 'tabs');
  });
});

check('a phone: nothing overflows, a tap plays', () =>
  on('map.html', { width: 360, height: 740, touch: true, motion: false, dark: true }, async (p) => {
    await p.until(fields);
    await p.tap(...(await p.spot('#map', 0.5, 0.5)));
    await p.until(played);
    for (const tab of ['map', 'scenario', 'about']) {
      await p.evaluate(`document.querySelector('#tab-${tab}').click()`);
      const [wide, window] = await p.evaluate(`[document.documentElement.scrollWidth, innerWidth]`);
      assert(wide <= window, `${tab}: ${wide} of ${window} px`);
    }
    same(await p.evaluate(`document.documentElement.dataset.theme`), 'dark', 'theme');
    await p.evaluate(`document.querySelector('#theme').click()`);
    same(await p.evaluate(`document.documentElement.dataset.theme`), 'light', 'theme');
  }));

check('names for those who do not see', () =>
  on('map.html', { motion: false }, async (p) => {
    await p.until(fields);
    const bare = await p.evaluate(`[...document.querySelectorAll('button, input, select, canvas[tabindex]')].filter((e) => !e.closest('[hidden]'))
      .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length)).map((e) => e.outerHTML.slice(0, 80))`);
    same(bare.join(), '', 'controls without a name');
  }));

let number = 0;
for (const [name, f] of checks) {
  if (only && !name.includes(only)) continue;
  number++;
  try {
    await f();
    console.log(`ok ${number} - ${name}`);
  } catch (problem) {
    console.log(`not ok ${number} - ${name}\n# ${String(problem.stack ?? problem).replace(/\n/g, '\n# ')}`);
  }
}
console.log(`1..${number}`);
