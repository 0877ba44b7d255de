// colours.ts - colours of words and numbers: those of the pictures (analysis/draw/style.gp), after Okabe and Ito
// (2008) and cividis (Nunez, Anderton, Renslow 2018). Those of outcomes come with the data.

export const hues = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7a7a7a'];
const palette = [0x00224e, 0x434e6c, 0x7d7c78, 0xbcae6c, 0xfee838];

// As ImageData has them in memory: red, green, blue, opaque.
export function pixel(colour: string): number {
  const c = parseInt(colour.slice(1), 16);
  return (0xff000000 | ((c & 255) << 16) | (c & 0xff00) | (c >> 16)) >>> 0;
}

export function numberColour(share: number): string {
  const at = Math.min(3.9999, Math.max(0, share * 4));
  const k = Math.floor(at);
  const mix = (shift: number): number => {
    const a = (palette[k] >> shift) & 255;
    const b = (palette[k + 1] >> shift) & 255;
    return Math.round(a + (at - k) * (b - a));
  };
  return '#' + ((mix(16) << 16) | (mix(8) << 8) | mix(0)).toString(16).padStart(6, '0');
}

export const numberPixels = Uint32Array.from({ length: 256 }, (_, k) => pixel(numberColour(k / 255)));
export const gradient = (way: string): string =>
  `linear-gradient(${way}, ${palette.map((c) => '#' + c.toString(16).padStart(6, '0')).join(', ')})`;
