// dom.ts - elements of the page. All text goes in as text, never as markup.

type Child = Node | string | null;
type Attributes = Record<string, string | number | boolean | ((event: never) => void) | undefined>;

// An element with attributes (`onclick: f` listens; true: present, false: absent) and children.
export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name.slice(2), value as unknown as EventListener);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false && value !== undefined) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((c): c is Node | string => c !== null));
  return element;
}

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element "${id}"`);
  return found as T;
}

export function options(select: HTMLSelectElement, list: { value: string; text: string }[], value: string): void {
  select.replaceChildren(...list.map((o) => el('option', { value: o.value, selected: o.value === value }, o.text)));
  select.value = value;
}

// A canvas of the size that its element has on the screen; coordinates are CSS pixels.
export function context(canvas: HTMLCanvasElement): { g: CanvasRenderingContext2D; width: number; height: number } {
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const ratio = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const g = canvas.getContext('2d')!;
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  return { g, width, height };
}

// A colour or another value of the style sheet.
export const style = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// At most one call a frame.
export function eachFrame(f: () => void): () => void {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      f();
    });
  };
}

// What went wrong, in a line that stays until it is closed.
export function complain(problem: unknown): void {
  const text = problem instanceof Error ? problem.message : String(problem);
  byId('problem-text').textContent = text;
  byId('problem').hidden = false;
  console.error(problem);
}

export async function copy(text: string, button: HTMLButtonElement): Promise<void> {
  const before = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = el('textarea', {});
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
  button.textContent = 'copied';
  setTimeout(() => (button.textContent = before), 1200);
}

export const download = (name: string, text: string): void => {
  const link = el('a', { href: URL.createObjectURL(new Blob([text], { type: 'text/plain' })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};

// A command to copy.
export function command(text: string): HTMLElement {
  const button: HTMLButtonElement = el('button', { type: 'button', onclick: () => void copy(text, button) }, 'copy');
  return el('div', { class: 'command' }, el('code', {}, text), button);
}
