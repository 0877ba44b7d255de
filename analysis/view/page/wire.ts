// wire.ts - values of a scenario: as they are typed (YAML in a line, as after --set on the command line), and as wire
// text, the form in which the engine takes them:
//   s<bytes>:<text> scalar, q<bytes>:<text> quoted scalar, l<count>:items, m<count>:pairs of <bytes>:<key> and item.

// What cannot be done as it was asked for; any other error leaves an engine that is not to be trusted.
export class Refusal extends Error {}

const encoder = new TextEncoder();
const counted = (text: string): string => `${encoder.encode(text).length}:${text}`;

// Throws a Refusal that says what is wrong with the text.
export function wireOf(text: string): string {
  let at = 0;
  const blank = (): void => {
    while (at < text.length && /\s/.test(text[at])) at++;
  };
  const fail = (what: string): never => {
    throw new Refusal(`${what} at character ${at + 1} of "${text}"`);
  };
  const quoted = (): string => {
    const mark = text[at++];
    let value = '';
    for (; at < text.length; at++) {
      if (text[at] === mark && mark === "'" && text[at + 1] === mark) at++;
      else if (text[at] === mark) {
        at++;
        return value;
      } else if (mark === '"' && text[at] === '\\') at++;
      value += text[at] ?? '';
    }
    return fail('a quote is not closed');
  };
  const plain = (stop: RegExp): string => {
    const from = at;
    while (at < text.length && !stop.test(text[at])) at++;
    return text.slice(from, at).trim();
  };
  const items = (close: string, one: () => string): string[] => {
    const found: string[] = [];
    at++;
    for (blank(); text[at] !== close; blank()) {
      if (at >= text.length) fail(`${close} is missing`);
      found.push(one());
      blank();
      if (text[at] === ',') at++;
      else if (text[at] !== close) fail(`, or ${close} is missing`);
    }
    at++;
    return found;
  };
  const value = (stop: RegExp): string => {
    blank();
    if (text[at] === '"' || text[at] === "'") return 'q' + counted(quoted());
    if (text[at] === '[') {
      const list = items(']', () => value(/[,\]]/));
      return `l${list.length}:${list.join('')}`;
    }
    if (text[at] === '{') {
      const pairs = items('}', () => {
        const key = text[at] === '"' || text[at] === "'" ? quoted() : plain(/[:,}]/);
        blank();
        if (text[at++] !== ':') fail('a key without a value');
        return counted(key) + value(/[,}]/);
      });
      return `m${pairs.length}:${pairs.join('')}`;
    }
    const scalar = plain(stop);
    if (scalar === '') fail('a value is missing');
    return 's' + counted(scalar);
  };
  const whole = value(/[^\s\S]/);
  blank();
  if (at < text.length) fail('there is more than one value');
  return whole;
}

// A word of the shell, quoted where it must be.
export function shellWord(text: string): string {
  return /^[\w./=:@%+,-]+$/.test(text) ? text : `'${text.replace(/'/g, `'\\''`)}'`;
}
