// page_cases.mjs - the engine of a page against the program: cases of pages simulated again, outside of a browser. What
// the checksums of the file cover, every bit of every answer and of the last state, has to be the same.
// Usage: node page_cases.mjs CASES PAGE.html...  (that many of each, evenly spread)
// PAGE.html|PATH=VALUE|...|OTHER.html: the page with values changed against the file of the other. Speaks TAP.
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { inflateSync } from 'node:zlib';

const sizes = { u8: 1, u32: 4, f32: 4, f64: 8 };
const arrays = { u8: Uint8Array, u32: Uint32Array, f32: Float32Array, f64: Float64Array };
const inferred = (page) => (page.head.blocks.inferred ? page.block('inferred') : new Uint8Array(page.head.cases));

function read(file) {
  const html = readFileSync(file, 'utf8');
  const element = (id) => html.match(new RegExp(`id="${id}">([^<]*)</script>`))[1];
  const head = JSON.parse(element('head'));
  const block = (name) => {
    const { type, count } = head.blocks[name];
    const packed = inflateSync(Buffer.from(element(`block-${name}`), 'base64'));
    const bytes = new Uint8Array(packed.length);
    for (let k = 0; k < sizes[type]; k++) for (let i = 0; i < count; i++) bytes[i * sizes[type] + k] = packed[k * count + i];
    return new arrays[type](bytes.buffer);
  };
  return { head, block, module: new WebAssembly.Module(inflateSync(Buffer.from(element('engine'), 'base64'))) };
}

const bytes = (text) => new TextEncoder().encode(text);
// A value as --set takes it, without its brackets and commas: a plain scalar of wire text.
const wire = (set) => set.replace(/=(.*)$/, (_, value) => `=s${bytes(value).length}:${value}`);

// The engine with the file's scenario open, and values changed.
function start(page, sets) {
  const nothing = new Proxy({}, { get: () => () => 0 });
  // A law of the user's own is a module beside it, called with copies of its numbers.
  const law = page.head.blocks.law && new WebAssembly.Instance(new WebAssembly.Module(page.block('law')), { wasi_snapshot_preview1: nothing }).exports;
  const call = (at, count) => {
    const theirs = new Float64Array(e.memory.buffer, at, count);
    const own = new Float64Array(law.memory.buffer, law.room(), count);
    own.set(theirs);
    law.call();
    theirs.set(own);
    return 1;
  };
  const e = new WebAssembly.Instance(page.module, { wasi_snapshot_preview1: nothing, page: { law: call } }).exports;
  const text = (p) => {
    const bytes = new Uint8Array(e.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(p, bytes.indexOf(0, p)));
  };
  const put = (numbers) => {
    const bytes = new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength);
    const p = e.alloc(bytes.length);
    new Uint8Array(e.memory.buffer).set(bytes, p);
    return p;
  };
  const need = (good) => {
    if (!good) throw new Error(text(e.message()));
    return good;
  };
  const { head, block } = page;
  e._initialize();
  if (law) law._initialize?.();
  if (law) e.file_law(law.memory_size());
  need(e.file_open(put(bytes(head.wire + '\0')), head.single ? head.index : -1));
  head.axes.forEach((_, a) => {
    const values = block(`axis-${a}`);
    need(e.file_axis(a, put(values), values.length));
  });
  need(e.file_designs(put(block('designs')), put(block('design-status')), head.designs.count));
  e.file_stored(head.stored, -1);
  need(e.view_open(put(bytes(sets.map((set) => wire(set) + '\0').join('') + '\0'))));
  return { e, put, need };
}

function compare(item, wanted) {
  const [file, ...sets] = item.split('|');
  const page = read(sets.length ? sets.pop() : file);
  const { e, put, need } = start(read(file), sets);
  const simulated = [...page.block('kind').keys()].filter((i) => !inferred(page)[i]);
  const n = Math.min(wanted, simulated.length);
  const cases = Float64Array.from({ length: n }, (_, i) => simulated[Math.floor(((i + 0.5) * simulated.length) / n)]);
  const [kind, checksum, answers] = [e.alloc(n), e.alloc(4 * n), e.alloc(8 * n * e.answer_count())];
  need(e.run(put(cases), n, kind, checksum, answers));
  const [kinds, sums] = [page.block('kind'), page.block('checksum')];
  const unlike = [...cases].filter((c, i) => kinds[c] !== new Uint8Array(e.memory.buffer)[kind + i] || sums[c] !== new Uint32Array(e.memory.buffer, checksum, n)[i]);
  if (unlike.length) throw new Error(`${unlike.length} of ${n} cases are not as in the file, case ${unlike[0]} first`);
  return n;
}

const [wanted, ...files] = process.argv.slice(2);
let all = 0;
files.forEach((file, k) => {
  try {
    const n = compare(file, Number(wanted));
    all += n;
    console.log(`ok ${k + 1} - ${basename(file.replace(/\|[^|]*$/, ''), '.html')}: ${n} cases, the same bits`);
  } catch (problem) {
    console.log(`not ok ${k + 1} - ${basename(file.replace(/\|[^|]*$/, ''), '.html')}: ${problem.message}`);
  }
});
console.log(`## ${all} cases of ${files.length} pages have the bits of their files`);
console.log(`1..${files.length}`);
