// Pages of the service: hostile texts, failures, tokens, focus, policy, accessibility. The real daemon, in Chromium.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open_page } from './browser.mjs';
import { Daemon } from './daemon.mjs';
import { PageSession, check_with_axe, sha256, throttle } from './page_session.mjs';

let session, daemon, browser, sample, groom, sky, bake;

before(async () => {
    session = await PageSession.start();
    ({ daemon, browser, sample, groom, sky, bake } = session);
    await session.put_name('environment', 'stage/sunset', sky);
    const head = readFileSync(join(sample, 'head.obj'));
    await fetch(`${daemon.address}/v1/blobs/${sha256(head)}`, { method: 'PUT', body: head });
    await session.put_name('mesh', 'heads/round', sha256(head));
});
after(() => session?.stop());

test('hostile names are text', async () => {
    const hostile = '<img src=x onerror="document.title=1">&lt;script&gt;.hdr';
    const evil_note = '<svg onload=alert(1)>';
    await session.with_page(async page => {
        page.on('dialog', () => assert.fail('a script of a name ran'));
        await page.goto(`${daemon.address}/#/environments`);
        await page
            .locator('.drop-zone input[type=file]')
            .setInputFiles({ name: hostile, mimeType: '', buffer: readFileSync(join(sample, 'overcast.hdr')) });
        await page.locator('.card h3', { hasText: hostile }).waitFor();
        assert.equal(await page.locator('.job strong').innerText(), hostile);
        assert.equal(await page.locator('img[src=x], svg[onload]').count(), 0);
        const card = page.locator('.card', { has: page.locator('h3', { hasText: hostile }) });
        await card.getByText('Give a name').click();
        const suggestion = await card.getByLabel('Name', { exact: false }).first().inputValue();
        assert.match(suggestion, /^[A-Za-z0-9._-]+$/);
        await card.getByLabel('Note').fill(evil_note);
        await card.getByRole('button', { name: 'Give this name' }).click();
        await page.locator('.card .names a', { hasText: suggestion }).click();
        await page.locator('td', { hasText: evil_note }).waitFor();
        assert.equal(await page.locator('main svg').count(), 0);
    });
});

test('a hair model that calls itself a script is text', async () => {
    const info = '<script>alert(1)</script>';
    const bytes = session.groom_with(info);
    await session.with_page(async page => {
        page.on('dialog', () => assert.fail('a script of a model ran'));
        await page.goto(`${daemon.address}/#/models`);
        await page
            .locator('.drop-zone input[type=file]')
            .setInputFiles({ name: 'evil.hair', mimeType: '', buffer: bytes });
        const card = page.locator('.card', { hasText: 'evil.hair' });
        await card.getByText('Facts').click();
        await card.locator('dd', { hasText: info }).waitFor();
    });
});

test('a bake that fails says why, and another can be cancelled from the queue', async () => {
    const dark = await daemon.add('environment', join(sample, 'overcast.hdr'));
    // A mesh that is not an OBJ file makes the worker fail.
    const junk = Buffer.from('no mesh at all');
    await fetch(`${daemon.address}/v1/blobs/${sha256(junk)}`, { method: 'PUT', body: junk });
    const failing = await daemon.post('/v1/bakes', {
        hair: `sha256:${groom}`,
        environment: `sha256:${dark}`,
        occluder: `sha256:${sha256(junk)}`,
    });
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/bakes/${failing.id}`);
        await page.getByRole('heading', { name: 'Why it failed' }).waitFor();
        assert.match(await page.locator('[role=alert] p').innerText(), /sha256:[0-9a-f]{64}/);
        await check_with_axe(page, 'failed bake');
        // Tracing with the most directions takes some minutes.
        const slow = await daemon.post('/v1/bakes', {
            hair: `sha256:${groom}`,
            transmittance: { method: 'trace', directions: 4096, direction_set: 'random' },
        });
        await page.goto(`${daemon.address}/#/bakes/${slow.id}`);
        await page.locator('progress').waitFor();
        await check_with_axe(page, 'running bake');
        await page.goto(`${daemon.address}/#/bakes`);
        await page.getByRole('button', { name: /^Cancel/ }).click();
        await page.locator('.state-cancelled').waitFor();
    });
});

test('a result by the method sh shows the error that its manifest predicts', async () => {
    const request = {
        environment: `sha256:${sky}`,
        irradiance: { method: 'sh', face_size: 4, specular_maps: 5, sh_bands: { diffuse: 3, specular: 8 } },
    };
    const { id } = await daemon.post('/v1/bakes', request);
    await daemon.finished(id);
    const { predicted_error } = (await daemon.json(`/v1/bakes/${id}/files/manifest.json`)).irradiance;
    assert.ok(predicted_error.diffuse > 0 && predicted_error.specular > 0);
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/bakes/${id}`);
        const shown = async term => page.locator('.facts div', { hasText: term }).locator('dd').innerText();
        assert.equal(await shown('SH bands'), 'diffuse 3, specular 8');
        for (const lobe of ['diffuse', 'specular']) {
            const text = await shown(`Predicted SH error of the ${lobe} map`);
            const error = parseFloat(text) / 100; // per cent, three digits
            assert.ok(Math.abs(error - predicted_error[lobe]) <= 0.006 * predicted_error[lobe], text);
            assert.match(text, /% of the largest value$/);
        }
    });
});

test('with tokens the page demands one, accepts the right one only, and forgets it on signing out', async () => {
    const token = 'a-token-of-this-test';
    const locked = await Daemon.start({ token });
    try {
        const use_tokens = async page => {
            await page.goto(locked.address);
            await page.getByLabel('Token').fill('wrong');
            await page.getByRole('button', { name: 'Open' }).click();
            await page.getByText('The service does not know this token').waitFor();
            await check_with_axe(page, 'token form');
            await page.getByLabel('Token').fill(token);
            await page.getByRole('button', { name: 'Open' }).click();
            await page.getByText('No environment is stored yet.').waitFor();
            await page.locator('.drop-zone input[type=file]').setInputFiles(join(sample, 'sky.hdr'));
            await page.locator('.card').waitFor();
            const [cookie] = await page.context().cookies();
            assert.ok(cookie.httpOnly && cookie.sameSite === 'Strict');
            await throttle(page, 0);
            await page.getByRole('button', { name: 'Sign out' }).click();
            await page.getByRole('alert').getByText('The service does not answer').waitFor();
            await throttle(page, -1);
            assert.match(await page.evaluate(() => JSON.stringify(localStorage)), /sky\.hdr/);
            await page.getByRole('button', { name: 'Sign out' }).click();
            await page.getByLabel('Token').waitFor();
            assert.equal(await page.evaluate(() => JSON.stringify(localStorage)), '{}');
        };
        await session.with_page(use_tokens, { address: locked.address });
    } finally {
        await locked.stop();
    }
});

test('navigation moves the focus to the heading and sets the title', async () => {
    await session.with_page(async page => {
        await page.goto(daemon.address);
        await page.locator('.card').first().waitFor();
        for (let i = 0; i < 4; ++i) await page.keyboard.press('Tab'); // skip link, hairbake, Environments, Models
        await page.keyboard.press('Enter');
        await page.getByRole('heading', { level: 1, name: 'Hair models' }).waitFor();
        await page.waitForFunction(() => document.activeElement?.tagName === 'H1');
        assert.equal(await page.title(), 'Hair models · hairbake');
    });
});

test('the policy stops an inline script', async () => {
    const { context, page, faults } = await open_page(browser, daemon.address);
    await page.goto(daemon.address);
    await page.evaluate(() => {
        const script = document.createElement('script');
        script.textContent = 'document.title = "ran"';
        document.body.append(script);
    });
    assert.notEqual(await page.title(), 'ran');
    assert.ok(
        faults.some(text => /Content Security Policy/.test(text)),
        'and the browser says so',
    );
    await context.close();
});

// [name, address, element to scroll to, element that is there when the page is complete]
const pages = [
    ['environments', '', '.card'],
    ['models', '#/models', '.card'],
    ['meshes', '#/meshes', 'tbody tr'],
    ['bake form', `#/bake`, 'form button[type=submit]'],
    ['bakes', '#/bakes', 'tbody tr'],
    ['result', () => `#/bakes/${bake}`, '.histogram', '.chart canvas'],
    ['re-bake', () => `#/rebake?bakes=${bake}`, '.choice'],
    ['name', '#/names/environment/stage/sunset', '#followers'],
    ['name of a mesh', '#/names/mesh/heads/round', '#followers'],
    ['viewer', () => `#/view/${bake}`, 'canvas'],
    ['no page', '#/nowhere', 'h1'],
];

for (const colorScheme of ['light', 'dark'])
    for (const [name, hash, seen, whole = seen] of pages)
        test(`axe finds nothing wrong: ${name}, ${colorScheme}`, async () => {
            await session.with_page(
                async page => {
                    await page.goto(`${daemon.address}/${typeof hash === 'function' ? hash() : hash}`);
                    await page.locator(seen).first().scrollIntoViewIfNeeded();
                    await page.locator(whole).first().waitFor();
                    await page.evaluate(() => document.querySelectorAll('details').forEach(one => (one.open = true)));
                    await page.evaluate(
                        () => new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn))),
                    );
                    await check_with_axe(page, `${name}, ${colorScheme}`);
                },
                { colorScheme },
            );
        });
