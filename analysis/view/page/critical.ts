// critical.ts - how far a number may go before a case ends otherwise, found as `stance critical` finds it: first values
// evenly spread, then halves of where the end is lost for the first time.
const first = 32;
const halvings = 10;

export interface Critical {
  kept: number;
  lost: number | null; // null: kept up to the end
  kind: number; // of the case at `lost`
  again: [number, number][]; // of the first values those that are kept beyond
}

// Of a case that ends as `of` at `from`; `simulate` tells how it ends at a value. It is followed to the first value that
// the scenario does not admit; what is wrong with the very first is thrown.
export async function critical(simulate: (x: number) => Promise<number>, of: number, from: number, to: number): Promise<Critical> {
  const values = Array.from({ length: first + 1 }, (_, k) => from + (k / first) * (to - from));
  const told = await Promise.allSettled(values.map((x, k) => (k === 0 ? of : simulate(x))));
  const kinds: number[] = [];
  for (const one of told) {
    if (one.status === 'rejected' && kinds.length === 1) throw one.reason;
    if (one.status === 'rejected') break;
    kinds.push(one.value);
  }
  const end = kinds.findIndex((kind) => kind !== of);
  if (end < 0) return { kept: values[kinds.length - 1], lost: null, kind: of, again: [] };
  let [kept, lost, kind] = [values[end - 1], values[end], kinds[end]];
  for (let n = 0; n < halvings; n++) {
    const x = (kept + lost) / 2;
    const here = await simulate(x);
    if (here === of) kept = x;
    else [lost, kind] = [x, here];
  }
  const again: [number, number][] = [];
  for (let k = end + 1; k < kinds.length; k++)
    if (kinds[k] === of) {
      if (kinds[k - 1] === of) again[again.length - 1][1] = values[k];
      else again.push([values[k], values[k]]);
    }
  return { kept, lost, kind, again };
}
