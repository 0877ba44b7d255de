// wasi.mjs - runs a program that is compiled for WebAssembly, in node or in a headless Chromium; it may print and end:
//
//   node --no-warnings tests/wasi.mjs [--browser] PROGRAM [ARGUMENT ...]
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { browser, open } from './web.mjs';

// What the program asks of its system (WASI, preview 1), as far as a program that prints asks. Its status and what it said.
async function execute(bytes, args) {
  let memory;
  let said = '';
  let status = 0;
  const end = {}; // thrown where the program exits
  const text = new TextDecoder();
  const encoded = args.map((a) => new TextEncoder().encode(`${a}\0`));
  const word = (at, value) => new DataView(memory.buffer).setUint32(at, value, true);
  const wasi_snapshot_preview1 = {
    args_sizes_get: (count, size) => (word(count, encoded.length), word(size, encoded.reduce((sum, a) => sum + a.length, 0)), 0),
    args_get(pointers, at) {
      encoded.forEach((a, k) => {
        word(pointers + 4 * k, at);
        new Uint8Array(memory.buffer).set(a, at);
        at += a.length;
      });
      return 0;
    },
    clock_time_get: (clock, precision, at) => (new DataView(memory.buffer).setBigUint64(at, BigInt(Math.round(1e6 * performance.now())), true), 0), // ns
    fd_close: () => 0,
    fd_fdstat_get: (fd, at) => (new Uint8Array(memory.buffer).fill(0, at, at + 24).fill(2, at, at + 1), 0),
    fd_seek: () => 70, // a pipe
    fd_write(fd, pieces, count, written) {
      const view = new DataView(memory.buffer);
      let sum = 0;
      for (let k = 0; k < count; k++) {
        const [at, size] = [view.getUint32(pieces + 8 * k, true), view.getUint32(pieces + 8 * k + 4, true)];
        said += text.decode(new Uint8Array(memory.buffer, at, size), { stream: true });
        sum += size;
      }
      word(written, sum);
      return 0;
    },
    proc_exit(code) {
      status = code;
      throw end;
    },
  };
  const { instance } = await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1 });
  memory = instance.exports.memory;
  try {
    instance.exports._start();
  } catch (problem) {
    if (problem !== end) throw problem;
  }
  return { status, said };
}

async function inBrowser(bytes, args) {
  const directory = mkdtempSync(join(tmpdir(), 'stance-wasi-'));
  writeFileSync(join(directory, 'page.html'), `<script>const program = Uint8Array.from(atob('${bytes.toString('base64')}'), (c) => c.charCodeAt(0)); ${execute}</script>`);
  const page = await open(join(directory, 'page.html'));
  try {
    return await page.evaluate(`execute(program, ${JSON.stringify(args)})`);
  } finally {
    await page.close();
    rmSync(directory, { recursive: true });
  }
}

const args = process.argv.slice(2);
const there = args[0] === '--browser' && args.shift();
if (there && !browser) throw new Error('there is no Chromium');
const { status, said } = await (there ? inBrowser : execute)(readFileSync(args[0]), args);
process.stdout.write(said);
process.exitCode = status;
