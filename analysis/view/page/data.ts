// data.ts - the data of the page: its head, and its blocks of numbers, each unpacked when it is first asked for.
// What the map is drawn from stands before the script, all else behind it: the map is there while that is being read.
// A block is base64 of a zlib stream of little-endian numbers, those of more than one byte shuffled: all first bytes, then
// all second ones, ...
import { numberKinds } from './layers';
import type { FileAxis, Head } from './format';
import { spacing, type Spacing } from './numbers';

export type Numbers = Uint8Array | Uint32Array | Float32Array | Float64Array;

const byteSize = { u8: 1, u32: 4, f32: 4, f64: 8 };

function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// All of the page has been read; it ends with the mark of its end, unless it was cut off.
export const whole = new Promise<void>((done) => {
  if (document.readyState === 'loading') document.addEventListener('DOMContentLoaded', () => done());
  else done();
});
export const isCut = (): boolean => !document.getElementById('end');

// The bytes of a script element of the page.
export async function unpack(id: string): Promise<Uint8Array<ArrayBuffer>> {
  if (!document.getElementById(id)?.nextElementSibling) await whole;
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no part "${id}": it is damaged`);
  const packed = new Blob([bytesOf((element.textContent ?? '').trim())]);
  const stream = packed.stream().pipeThrough(new DecompressionStream('deflate'));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new Error(`part "${id}" of the page is damaged`);
  }
}

function unshuffle(bytes: Uint8Array, size: number): ArrayBuffer {
  const count = bytes.length / size;
  const out = new Uint8Array(bytes.length);
  for (let b = 0; b < size; b++) for (let i = 0, from = b * count; i < count; i++) out[i * size + b] = bytes[from + i];
  return out.buffer;
}

// What a page of charts alone has not.
const absent: Partial<Head> = {
  file_program: '', file_revision: '', date: '', scenario: '', wire: null, command_file: '', cases: 0, single: false, index: 0, axes: [], sample: -1,
  varied: [], designs: { count: 0, numbers: 0 }, kinds: [], answers: [], checksums: false, left_out: [], engine: false, stored: 0, number: -1, blocks: {}, recorded: [],
};

export interface Axis extends FileAxis {
  spacing: Spacing;
  stride: number; // of the flat index
}

export class Data {
  readonly head: Head;
  readonly axes: Axis[];
  private blocks = new Map<string, Promise<Numbers>>();

  constructor() {
    const text = document.getElementById('head')?.textContent;
    if (!text) throw new Error('the page carries no data; stance view FILE writes pages that do');
    this.head = { ...absent, ...(JSON.parse(text) as Head) };
    if (this.head.format !== 1) throw new Error(`the data of the page have format ${this.head.format}, the page reads format 1`);
    numberKinds(this.head.kinds);
    let stride = this.head.axes.reduce((n, a) => n * a.count, 1);
    this.axes = this.head.axes.map((a) => {
      stride /= a.count;
      return { ...a, stride, spacing: spacing(a.values, a.words !== null) };
    });
  }

  has(name: string): boolean {
    return name in this.head.blocks;
  }

  block(name: string): Promise<Numbers> {
    let found = this.blocks.get(name);
    if (!found) this.blocks.set(name, (found = this.unpacked(name)));
    return found;
  }

  private async unpacked(name: string): Promise<Numbers> {
    const { type, count } = this.head.blocks[name];
    const bytes = await unpack('block-' + name);
    if (bytes.length !== count * byteSize[type]) throw new Error(`block "${name}" of the page is damaged`);
    if (type === 'u8') return bytes;
    const buffer = unshuffle(bytes, byteSize[type]);
    return type === 'u32' ? new Uint32Array(buffer) : type === 'f32' ? new Float32Array(buffer) : new Float64Array(buffer);
  }

  // Places along the axes of a case.
  places(index: number): number[] {
    return this.axes.map((a) => Math.floor(index / a.stride) % a.count);
  }

  index(places: number[]): number {
    return this.axes.reduce((sum, a, k) => sum + a.stride * places[k], 0);
  }
}
