// Shared by the viewer's tests: the staged files behind a small server on a free port, and pages of a browser.
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';
import { stage_page } from './daemon.mjs';

export { launch as open_browser } from './browser.mjs';

const types = {
    '.html': 'text/html; charset=utf-8',
    '.js': 'text/javascript',
    '.css': 'text/css',
    '.json': 'application/json',
    '.svg': 'image/svg+xml',
};
const policy =
    "default-src 'self'; img-src 'self' blob: data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/** The files that the service serves, in a folder of their own. {folder, remove()} */
export function stage() {
    const parent = mkdtempSync(join(tmpdir(), 'hairbake-web-'));
    const folder = join(parent, 'site');
    stage_page(folder);
    return { folder, remove: () => rmSync(parent, { recursive: true, force: true }) };
}

/**
 * Serves `folder` on a free port of 127.0.0.1, with the page's Content-Security-Policy. `answer(method, path, body)`
 * comes first and may give {status, type, body}. {origin, close()}
 */
export async function serve(folder, answer = () => undefined) {
    const server = createServer(async (request, response) => {
        const path = decodeURIComponent(new URL(request.url, 'http://x').pathname);
        const pieces = [];
        for await (const piece of request) pieces.push(piece);
        if (path === '/favicon.ico') return response.writeHead(204).end();
        const given = (await answer(request.method, path, Buffer.concat(pieces))) ?? file_at(folder, path);
        response.writeHead(given.status ?? 200, { 'Content-Type': given.type, 'Content-Security-Policy': policy });
        response.end(given.body);
    });
    await new Promise(listening => server.listen(0, '127.0.0.1', listening));
    return {
        origin: `http://127.0.0.1:${server.address().port}`,
        close: () =>
            new Promise(closed => {
                server.close(closed);
                server.closeAllConnections();
            }),
    };
}

function file_at(folder, path) {
    try {
        return { type: types[extname(path)] ?? 'application/octet-stream', body: readFileSync(join(folder, path)) };
    } catch {
        return { status: 404, type: 'text/plain', body: `no ${path}` };
    }
}

export function json(object, status = 200) {
    return { status, type: 'application/json', body: JSON.stringify(object) };
}

/** A new page whose console errors, exceptions and failed requests are collected in `page.problems`. */
export async function open_page(browser, options = {}) {
    const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
    page.problems = [];
    page.on('pageerror', error => page.problems.push(`exception: ${error.stack}`));
    page.on('console', message => {
        const waits = message.text().includes('GPU stall due to ReadPixels'); // expected: tests read frames back
        if (['error', 'warning'].includes(message.type()) && !waits) page.problems.push(message.text());
    });
    return page;
}
