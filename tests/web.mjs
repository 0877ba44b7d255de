// web.mjs - a headless Chromium driven over its pipe (DevTools protocol, no library): opens pages of files, clicks and
// types as a user does, reads what a user reads. For tests in JavaScript, see view.mjs.
//
//   const page = await open('page.html', { width: 1400, height: 900 });
//   await page.until(`document.querySelector('#legend')`); ... await page.close();
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const programs = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
const patience = parseInt(readFileSync(new URL('patience', import.meta.url), 'utf8')); // s
export const browser = programs.find((p) => p && existsSync(p)) ?? null;

// A browser of its own; `close` ends it.
async function launch() {
  const profile = mkdtempSync(join(tmpdir(), 'stance-web-'));
  const child = spawn(browser, ['--headless=new', '--no-sandbox', '--disable-gpu', '--no-first-run', '--disable-dev-shm-usage', '--hide-scrollbars',
    '--remote-debugging-pipe', `--user-data-dir=${profile}`, 'about:blank'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], detached: true,
    env: { ...process.env, TMPDIR: profile } });
  const waiting = new Map();
  const listeners = [];
  let next = 0;
  let rest = '';
  child.stdio[4].setEncoding('utf8').on('data', (text) => {
    const messages = (rest + text).split('\0');
    rest = messages.pop();
    for (const message of messages.map((m) => JSON.parse(m))) {
      const one = waiting.get(message.id);
      waiting.delete(message.id);
      if (one) message.error ? one.reject(new Error(`${one.method}: ${message.error.message}`)) : one.resolve(message.result);
      else listeners.forEach((f) => f(message));
    }
  });
  child.on('exit', () => waiting.forEach((one) => one.reject(new Error('the browser ended'))));
  const send = (method, params = {}, sessionId = undefined) =>
    new Promise((done, reject) => {
      const id = ++next;
      waiting.set(id, { resolve: done, reject, method });
      child.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + '\0');
    });
  const close = async () => {
    const ended = new Promise((done) => child.once('exit', done));
    await Promise.race([send('Browser.close').catch(() => {}), new Promise((done) => setTimeout(done, 3000))]);
    try {
      process.kill(-child.pid, 'SIGKILL'); // with the processes of its pages
    } catch {} // all have ended
    await ended;
    rmSync(profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 50 });
  };
  return { send, listeners, close };
}

// A page of a file, with `hash` after its address. Its errors and what it asked of the network are kept.
export async function open(file, { width = 1400, height = 900, dark = false, hash = '', touch = false, motion = true, before = '' } = {}) {
  const { send, listeners, close } = await launch();
  const { targetId } = await send('Target.createTarget', { url: 'about:blank' });
  const { sessionId } = await send('Target.attachToTarget', { targetId, flatten: true });
  const call = (method, params) => send(method, params, sessionId);
  const errors = [];
  const requests = [];
  listeners.push((m) => {
    if (m.sessionId !== sessionId) return;
    if (m.method === 'Runtime.exceptionThrown') errors.push(m.params.exceptionDetails.exception?.description ?? m.params.exceptionDetails.text);
    if (m.method === 'Runtime.consoleAPICalled' && m.params.type === 'error') errors.push(m.params.args.map((a) => a.description ?? a.value).join(' '));
    if (m.method === 'Log.entryAdded' && m.params.entry.level === 'error') errors.push(m.params.entry.text);
    if (m.method === 'Network.requestWillBeSent' && /^(https?|ws|ftp)/.test(m.params.request.url)) requests.push(m.params.request.url);
  });
  for (const domain of ['Runtime', 'Page', 'Log', 'Network']) await call(`${domain}.enable`);
  await call('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: touch });
  await call('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }, { name: 'prefers-reduced-motion', value: motion ? 'no-preference' : 'reduce' }] });
  if (touch) await call('Emulation.setTouchEmulationEnabled', { enabled: true });
  if (before) await call('Page.addScriptToEvaluateOnNewDocument', { source: before });

  const evaluate = async (expression) => {
    const r = await call('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true, userGesture: true });
    if (r.exceptionDetails) throw new Error(r.exceptionDetails.exception?.description ?? r.exceptionDetails.text);
    return r.result.value;
  };
  // Until an expression is true; its value.
  const until = async (expression) => {
    for (const end = Date.now() + 1000 * patience; ; await new Promise((done) => setTimeout(done, 30))) {
      const value = await evaluate(expression).catch(() => false);
      if (value) return value;
      if (Date.now() > end) throw new Error(`in ${patience} s never true: ${expression}; the page says: ${await evaluate('document.body.innerText.slice(0, 600)')}`);
    }
  };
  const visit = async (address) => {
    await call('Page.navigate', { url: address });
    await until(`document.readyState === 'complete'`);
  };
  const mouse = (type, x, y, more = {}) => call('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1, clickCount: 1, ...more });
  const move = (x, y) => mouse('mouseMoved', x, y, { button: 'none', buttons: 0 });
  const click = async (x, y, modifiers = 0) => {
    await move(x, y);
    await mouse('mousePressed', x, y, { modifiers });
    await mouse('mouseReleased', x, y, { modifiers });
  };
  const drag = async (x0, y0, x1, y1, modifiers = 0) => {
    await move(x0, y0);
    await mouse('mousePressed', x0, y0, { modifiers });
    for (let k = 1; k <= 5; k++) await mouse('mouseMoved', x0 + ((x1 - x0) * k) / 5, y0 + ((y1 - y0) * k) / 5, { modifiers });
    await mouse('mouseReleased', x1, y1, { modifiers });
  };
  // Where on the screen a share (0 ... 1, from the left and from below) of the map's plot is, or of any other element.
  const spot = async (selector, across = 0.5, up = 0.5) => {
    await evaluate(`document.querySelector(${JSON.stringify(selector)}).scrollIntoView({ block: 'nearest' })`);
    const [left, top, w, h] = await evaluate(`(() => { const r = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()`);
    const [l, t, r, b] = selector === '#map' ? [w < 480 ? 50 : 64, 8, 14, 46] : [0, 0, 0, 0];
    return [left + l + across * (w - l - r), top + t + (1 - up) * (h - t - b)];
  };
  const press = async (selector) => click(...(await spot(selector)));
  const key = async (name, modifiers = 0) => {
    const text = name.length === 1 ? name : name === 'Enter' ? '\r' : undefined;
    await call('Input.dispatchKeyEvent', { type: text ? 'keyDown' : 'rawKeyDown', key: name, text, modifiers, windowsVirtualKeyCode: { Enter: 13, ' ': 32, Tab: 9, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40 }[name] ?? 0 });
    await call('Input.dispatchKeyEvent', { type: 'keyUp', key: name, modifiers });
  };
  // Sets a control as a user does, so that the page hears of it.
  const set = (selector, value) => evaluate(`(() => { const e = document.querySelector(${JSON.stringify(selector)}); e.value = ${JSON.stringify(value)}; e.dispatchEvent(new Event('input', { bubbles: true })); e.dispatchEvent(new Event('change', { bubbles: true })); })()`);
  const text = (selector) => evaluate(`document.querySelector(${JSON.stringify(selector)})?.innerText ?? ''`);
  const tap = async (x, y) => {
    await call('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [{ x, y }] });
    await call('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  };
  const screenshot = async (to) => writeFileSync(to, Buffer.from((await call('Page.captureScreenshot', { format: 'png' })).data, 'base64'));
  // Colour of a pixel of a canvas, [red, green, blue], at a share of its plot.
  const pixel = async (selector, across, up) => {
    const [x, y] = await spot(selector, across, up);
    return evaluate(`(() => { const c = document.querySelector(${JSON.stringify(selector)}); const r = c.getBoundingClientRect(); const s = c.width / r.width;
      return [...c.getContext('2d').getImageData(Math.round((${x} - r.left) * s), Math.round((${y} - r.top) * s), 1, 1).data].slice(0, 3); })()`);
  };
  const page = { call, evaluate, until, visit, mouse, move, click, drag, spot, press, key, set, text, tap, screenshot, pixel, errors, requests, close };
  try {
    await visit(pathToFileURL(resolve(file)).href + hash);
  } catch (problem) {
    await close();
    throw problem;
  }
  return page;
}
