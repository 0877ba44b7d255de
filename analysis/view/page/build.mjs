// build.mjs - makes the page's template: script and style in one HTML file without data, in which `stance view`
// replaces the lines <!--stance:data-->, of what the map is drawn from, and <!--stance:more-->.
//
//   node build.mjs MODULES OUT
//     MODULES  folder node_modules that `npm ci` has made from package-lock.json, wherever it is
//     OUT      the template
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

if (process.argv.length !== 4) {
  console.error('usage: node build.mjs MODULES OUT');
  process.exit(2);
}
const here = dirname(fileURLToPath(import.meta.url));
const [modules, out] = process.argv.slice(2);
const need = createRequire(join(resolve(modules), 'here.js'));
const esbuild = need('esbuild');
const read = (...path) => readFileSync(join(...path), 'utf8');

// Types first: esbuild only drops them. Modules are found through a tsconfig.json beside them.
const config = join(dirname(resolve(modules)), 'tsconfig.json');
const paths = { '*': [join(resolve(modules), '*')] };
writeFileSync(config, JSON.stringify({ extends: join(here, 'tsconfig.json'), compilerOptions: { paths }, include: [join(here, '*.ts')] }));
try {
  execFileSync(process.execPath, [join(modules, 'typescript/bin/tsc'), '-p', config], { stdio: 'inherit' });
} catch {
  process.exit(1);
}

const bundle = (entry, define = {}) =>
  esbuild.buildSync({
    entryPoints: [join(here, entry)], bundle: true, minify: true, format: 'iife', target: 'es2022', charset: 'utf8', write: false,
    nodePaths: [resolve(modules)], define, legalComments: 'none', loader: { '.css': 'text' },
  }).outputFiles[0].text.trim();

const licences = ['uplot'].map((name) => `${name} ${JSON.parse(read(modules, name, 'package.json')).version}\n\n${read(modules, name, 'LICENSE')}`).join('\n');
const worker = bundle('worker.ts');
const script = bundle('main.ts', { WORKER: JSON.stringify(worker), LICENCES: JSON.stringify(licences) });
const css = (text) => esbuild.transformSync(text, { loader: 'css', minify: true }).code.trim();
const style = css(read(modules, 'uplot/dist/uPlot.min.css') + read(here, 'page.css'));
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const parts = {
  // Nothing from the network, no script but this one; what is simulated runs in workers made from a part of it.
  policy: [
    "default-src 'none'", `script-src ${hash(script)} 'wasm-unsafe-eval'`, `style-src ${hash(style)}`, 'worker-src blob:', 'img-src data: blob:',
    "connect-src 'none'", "base-uri 'none'", "form-action 'none'",
  ].join('; '),
  style,
  script,
};
const page = read(here, 'page.html').replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
for (const place of ['data', 'more'])
  if (page.split(`<!--stance:${place}-->`).length !== 2) throw new Error(`the template has not one place for ${place}`);
writeFileSync(out, page);
