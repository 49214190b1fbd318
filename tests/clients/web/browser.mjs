// Headless Chromium of the Debian package, and pages that collect their faults.
import { createRequire } from 'node:module';
import { dirname, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

export const tests = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
export const require_tool = createRequire(resolve(tests, 'npm/package.json'));
const { chromium } = require_tool('playwright-core');

export const chromium_path = '/usr/bin/chromium';
export const chromium_flags = [
    '--headless',
    '--no-sandbox',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--use-gl=angle',
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
];

export const launch = () => chromium.launch({ executablePath: chromium_path, headless: true, args: chromium_flags });

/** A page and the list of its faults: errors of scripts, violations of the policy, requests to other origins. */
export async function open_page(browser, origin, options = {}) {
    const context = await browser.newContext({
        viewport: { width: 1280, height: 720 },
        reducedMotion: 'reduce',
        ...options,
    });
    const page = await context.newPage();
    const faults = [];
    page.on('pageerror', error => faults.push(`error: ${error.stack ?? error.message}`));
    page.on('console', message => {
        if (/Content.Security.Policy/i.test(message.text())) faults.push(message.text());
    });
    context.on('request', request => {
        const url = new URL(request.url());
        if (url.protocol.startsWith('http') && url.origin !== origin)
            faults.push(`request to another origin: ${request.url()}`);
    });
    return { context, page, faults };
}
