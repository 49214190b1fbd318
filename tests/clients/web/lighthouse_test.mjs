// Lighthouse's scores of performance and accessibility, through nginx, with its desktop settings: the page is for
// 1280x720 and tablets. Its settings for phones would slow the processor of the test's machine down fourfold.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium_flags, chromium_path, require_tool } from './browser.mjs';
import { Daemon, hairbake } from './daemon.mjs';
import { free_port, start_nginx } from './nginx.mjs';

const { chromium } = require_tool('playwright-core');
const entry = require_tool.resolve('lighthouse');
const { default: lighthouse, desktopConfig } = await import(pathToFileURL(entry));

const token = 'a-token-of-this-test';
const least = 0.9;
const tries = 3; // other load can only lower the score, so the best of three counts

let daemon, nginx, browser, port, sample, bake;

before(async () => {
    sample = mkdtempSync(join(tmpdir(), 'hairbake-sample-'));
    hairbake('sample', sample, '--vertices', '30000', '--map-width', '256');
    daemon = await Daemon.start({ token }); // behind nginx it demands one
    nginx = await start_nginx(daemon.address);
    const hair = await daemon.add('model', join(sample, 'groom.hair'));
    const environment = await daemon.add('environment', join(sample, 'sky.hdr'));
    await daemon.add('environment', join(sample, 'studio.hdr'));
    bake = (
        await daemon.post('/v1/bakes', {
            hair: `sha256:${hair}`,
            environment: `sha256:${environment}`,
            outputs: ['raw'],
        })
    ).id;
    await daemon.finished(bake);
    port = await free_port();
    browser = await chromium.launch({
        executablePath: chromium_path,
        headless: true,
        args: [...chromium_flags, `--remote-debugging-port=${port}`],
    });
});

after(async () => {
    await browser?.close();
    await nginx?.stop();
    await daemon?.stop();
    rmSync(sample, { recursive: true, force: true });
});

async function scores(url) {
    const settings = { port, logLevel: 'error', output: 'json', onlyCategories: ['performance', 'accessibility'] };
    const { lhr } = await lighthouse(url, { ...settings, extraHeaders: daemon.headers }, desktopConfig);
    assert.equal(lhr.runtimeError, undefined);
    const asked = lhr.audits['network-requests'].details.items.filter(({ url: one }) => one.includes('/v1/'));
    assert.ok(asked.length > 0 && asked.every(({ statusCode }) => statusCode < 400), 'the page itself is scored');
    const low = Object.values(lhr.audits)
        .filter(({ score }) => score !== null && score < least)
        .map(({ id, displayValue = '' }) => `${id} ${displayValue}`);
    return { performance: lhr.categories.performance.score, accessibility: lhr.categories.accessibility.score, low };
}

for (const [name, hash] of [
    ['environments', () => ''],
    ['bake form', () => '#/bake'],
    ['result', () => `#/bakes/${bake}`],
])
    test(`${name}: performance and accessibility are at least ${least}`, async () => {
        let best = { performance: 0, accessibility: 0 };
        for (let i = 0; i < tries && best.performance < least; ++i) {
            const found = await scores(`${nginx.address}/${hash()}`);
            if (found.performance >= best.performance) best = found;
        }
        console.log(`${name}: performance ${best.performance}, accessibility ${best.accessibility}`);
        assert.ok(best.performance >= least, `performance ${best.performance}: ${best.low.join('; ')}`);
        assert.ok(best.accessibility >= least, `accessibility ${best.accessibility}: ${best.low.join('; ')}`);
    });
