// Writes the files that the service serves into one folder: our own modules unchanged, and vendor/ from node_modules.
//   node clients/web/stage.mjs FOLDER
// Every import of the page's modules is a relative path: '../vendor/three.js', '../vendor/preact.js' ...
import { cpSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, posix } from 'node:path';
import { fileURLToPath } from 'node:url';

const source = dirname(fileURLToPath(import.meta.url));
const not_served = new Set(['node_modules', 'package.json', 'package-lock.json', '.npmrc', 'stage.mjs']);
const vendor = {
    'three.js': 'three/build/three.module.min.js',
    'three.core.min.js': 'three/build/three.core.min.js', // three.js imports it by this name
    'preact_core.js': 'preact/dist/preact.module.js',
    'preact_hooks.js': 'preact/hooks/dist/hooks.module.js',
    'htm.js': 'htm/dist/htm.module.js',
    'tus.js': 'tus-js-client/dist/tus.min.js', // a plain script: window.tus
    'uplot.js': 'uplot/dist/uPlot.esm.js',
    'uplot.css': 'uplot/dist/uPlot.min.css',
    'pico.css': '@picocss/pico/css/pico.min.css',
    // SHA-256 in pieces, and the modules that it imports by these names
    ...Object.fromEntries(['sha2', '_md', '_u64', 'utils'].map(n => [`hashes/${n}.js`, `@noble/hashes/${n}.js`])),
};

// preact, its hooks and its templates as one module.
const preact = `import { h } from './preact_core.js';
import htm from './htm.js';
export { createContext, render } from './preact_core.js';
export { useCallback, useContext, useEffect, useMemo, useRef, useState } from './preact_hooks.js';
export const html = htm.bind(h);
`;

function stage(folder) {
    rmSync(folder, { recursive: true, force: true });
    mkdirSync(join(folder, 'vendor/hashes'), { recursive: true });
    for (const name of readdirSync(source))
        if (!not_served.has(name)) cpSync(join(source, name), join(folder, name), { recursive: true });
    for (const [name, from] of Object.entries(vendor))
        writeFileSync(
            join(folder, 'vendor', name),
            with_paths(without_map(readFileSync(join(source, 'node_modules', from), 'utf8'))),
        );
    writeFileSync(join(folder, 'vendor/preact.js'), preact);
    const index = join(folder, 'index.html');
    if (existsSync(index)) writeFileSync(index, with_preloads(readFileSync(index, 'utf8'), folder));
}

// A browser cannot import a package by its name.
function with_paths(text) {
    return text.replace(/\bfrom\s*"preact"/g, 'from"./preact_core.js"');
}

// Source maps are not served.
function without_map(text) {
    return text.replace(/^\/[/*]# sourceMappingURL=.*$/m, '');
}

// Preloads the modules of the first page, so that a browser fetches them all at once instead of level by level.
function with_preloads(html, folder) {
    const modules = new Set();
    const add = name => {
        if (modules.has(name)) return;
        modules.add(name);
        const text = readFileSync(join(folder, name), 'utf8');
        for (const [, path] of text.matchAll(/^(?:import|export)\b[^'"]*?['"](\.[^'"]+)['"]/gm))
            add(posix.join(posix.dirname(name), path));
    };
    add('app/main.js');
    add('app/pages/environments_page.js');
    const links = [...modules].map(name => `<link rel="modulepreload" href="{assets}/${name}">`);
    return html.replace('<!-- preload -->', links.join('\n'));
}

if (process.argv.length !== 3) {
    console.error('usage: node clients/web/stage.mjs FOLDER');
    process.exit(2);
}
stage(process.argv[2]);
