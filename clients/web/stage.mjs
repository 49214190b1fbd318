// Puts what the service serves into one folder: our own modules as they are, and vendor/ from node_modules.
//   node clients/web/stage.mjs FOLDER
// In the page's modules every import is a relative path: '../vendor/three.js', '../vendor/preact.js' ...
import { cpSync, mkdirSync, readdirSync, rmSync, writeFileSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const source = dirname(fileURLToPath(import.meta.url));
const not_served = new Set(['node_modules', 'package.json', 'package-lock.json', '.npmrc', 'stage.mjs']);
const vendor = {
    'three.js': 'three/build/three.module.min.js',
    'three.core.min.js': 'three/build/three.core.min.js', // three.js imports it by this name
    'preact.js': 'htm/preact/standalone.module.js', // preact, its hooks and htm in one module
    'tus.js': 'tus-js-client/dist/tus.min.js', // a plain script: window.tus
    'uplot.js': 'uplot/dist/uPlot.esm.js',
    'uplot.css': 'uplot/dist/uPlot.min.css',
    'pico.css': '@picocss/pico/css/pico.min.css',
};

function stage(folder) {
    rmSync(folder, { recursive: true, force: true });
    mkdirSync(join(folder, 'vendor'), { recursive: true });
    for (const name of readdirSync(source))
        if (!not_served.has(name)) cpSync(join(source, name), join(folder, name), { recursive: true });
    for (const [name, from] of Object.entries(vendor))
        writeFileSync(join(folder, 'vendor', name), without_map(readFileSync(join(source, 'node_modules', from), 'utf8')));
}

// Source maps are not served.
function without_map(text) {
    return text.replace(/^\/[/*]# sourceMappingURL=.*$/m, '');
}

if (process.argv.length !== 3) {
    console.error('usage: node clients/web/stage.mjs FOLDER');
    process.exit(2);
}
stage(process.argv[2]);
