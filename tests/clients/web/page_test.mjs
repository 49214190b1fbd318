// What the page must hold beyond the journey: uploads that are interrupted, tokens, failures in words, names, hostile
// texts, accessibility. The real daemon, in Chromium.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { in_new_places } from '../../../clients/web/app/bake/request_fields.js';
import { launch, open_page, require_tool } from './browser.mjs';
import { Daemon, hairbake, patience_ms } from './daemon.mjs';

const axe = readFileSync(require_tool.resolve('axe-core/axe.min.js'), 'utf8');
const sha256 = data => createHash('sha256').update(data).digest('hex');

let daemon, browser, sample, groom, sky, bake;

before(async () => {
    sample = mkdtempSync(join(tmpdir(), 'hairbake-sample-'));
    hairbake('sample', sample, '--vertices', '30000', '--map-width', '128');
    daemon = await Daemon.start();
    browser = await launch();
    groom = await daemon.add('model', join(sample, 'groom.hair'));
    sky = await daemon.add('environment', join(sample, 'sky.hdr'));
    const request = {
        hair: `sha256:${groom}`,
        environment: `sha256:${sky}`,
        outputs: ['npy', 'raw'],
        transmittance: { voxels: 32, directions: 16, reference_vertices: 16 },
        irradiance: { face_size: 4, specular_maps: 5 },
    };
    bake = (await daemon.post('/v1/bakes', request)).id;
    await daemon.finished(bake);
});

after(async () => {
    await browser?.close();
    await daemon?.stop();
    rmSync(sample, { recursive: true, force: true });
});

/** Runs `act` on a page of its own; whatever the page must not do is found at the end. */
async function with_page(address, act, options) {
    const { context, page, faults } = await open_page(browser, address, options);
    page.setDefaultTimeout(patience_ms);
    try {
        await act(page, context);
        assert.deepEqual(faults, []);
    } finally {
        await context.close();
    }
}

/** Sends at most so many bytes a second; 0: cuts the connection; -1: as fast as it goes. */
async function throttle(page, bytes_per_second) {
    page.cdp ??= await page.context().newCDPSession(page);
    await page.cdp.send('Network.emulateNetworkConditions', {
        offline: bytes_per_second === 0,
        latency: 0,
        downloadThroughput: -1,
        uploadThroughput: bytes_per_second,
    });
}

/** Offsets at which the page asked to go on: one a PATCH. */
function watch_patches(page) {
    const offsets = [];
    page.on('request', request => {
        if (request.method() === 'PATCH') offsets.push(Number(request.headers()['upload-offset']));
    });
    return offsets;
}

// A groom of some megabytes, another for every seed, so that sending takes a while at 3 MB a second.
function large_groom(seed) {
    const folder = join(sample, String(seed));
    hairbake('sample', folder, '--vertices', '600000', '--map-width', '16', '--seed', String(seed));
    return join(folder, 'groom.hair');
}
const slow = 3e6;

async function send_slowly(page, file) {
    await page.goto(`${daemon.address}/#/models`);
    await page.getByRole('heading', { name: 'Stored' }).waitFor({ state: 'attached' });
    await throttle(page, slow);
    await page.locator('.drop-zone input[type=file]').setInputFiles(file);
    await page.locator('.job[data-phase=sending] progress[value]').waitFor();
    await page.waitForFunction(() => document.querySelector('.job[data-phase=sending] progress')?.value > 0.15);
}

/** Points a name of the daemon at a file. */
const put_name = (kind, path, digest) =>
    daemon.json(`/v1/names/${kind}/${path}`, {
        method: 'PUT',
        headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify({ sha256: digest }),
    });

/** The sample's groom with other words in the 88 bytes of "info" of a HAIR header: a file that the service lacks. */
function groom_with(words) {
    const bytes = Buffer.from(readFileSync(join(sample, 'groom.hair')));
    bytes.write(`${words}\0`, 40);
    return bytes;
}

async function assert_stored(file) {
    const digest = sha256(readFileSync(file));
    const reply = await fetch(`${daemon.address}/v1/models/${digest}`);
    assert.equal(reply.status, 200, `${file} is not stored`);
}

test('an upload goes on where a reload of the page ended it', async () => {
    const file = large_groom(11);
    await with_page(daemon.address, async page => {
        const offsets = watch_patches(page);
        await send_slowly(page, file);
        await page.reload();
        await throttle(page, -1);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.ok(offsets.at(-1) > 0, `the last PATCH began at ${offsets.at(-1)}`);
        await assert_stored(file);
    });
});

test('an upload goes on after the connection was cut', async () => {
    const file = large_groom(12);
    await with_page(daemon.address, async page => {
        const offsets = watch_patches(page);
        await send_slowly(page, file);
        const begun = offsets.length;
        await throttle(page, 0);
        await page.waitForTimeout(300);
        await throttle(page, -1);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.ok(offsets.length > begun && offsets.at(-1) > 0, `PATCH requests began at ${offsets}`);
        await assert_stored(file);
    });
});

const turned_away = (detail, wait_s) => ({
    status: 429,
    headers: { 'Retry-After': String(wait_s) },
    contentType: 'application/problem+json',
    json: { detail },
});

test('an upload that is turned away for now waits as long as it is told, and goes on where it was', async () => {
    const file = large_groom(16);
    const words = 'more requests or uploads at once than allowed';
    await with_page(daemon.address, async page => {
        const offsets = watch_patches(page);
        const once = new Map(); // each kind of question is turned away the first time; a PATCH, the second piece
        await page.route(/\/v1\/(blobs|uploads|models)/, route => {
            const request = route.request();
            const kind = `${request.method()} ${new URL(request.url()).pathname.split('/')[2]}`;
            const is_first_piece = Number(request.headers()['upload-offset']) === 0;
            if (request.method() === 'GET' || is_first_piece || once.has(kind)) return route.continue();
            once.set(kind, Date.now());
            return route.fulfill(turned_away(words, kind === 'PATCH uploads' ? 2 : 0));
        });
        const asked_on = page.waitForRequest(request => request.method() === 'HEAD' && /uploads/.test(request.url()));
        await page.goto(`${daemon.address}/#/models`);
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await page.getByText(`The service is asked again: ${words}`).waitFor();
        await asked_on;
        const waited_ms = Date.now() - once.get('PATCH uploads');
        assert.ok(waited_ms >= 2000, `it was asked again after ${waited_ms} ms`);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.deepEqual(
            [...once.keys()],
            ['HEAD blobs', 'POST uploads', 'PATCH uploads', 'HEAD uploads', 'POST models'],
        );
        assert.equal(offsets.filter(offset => offset === 0).length, 1, `PATCH requests began at ${offsets}`);
        await assert_stored(file);
    });
});

test('a file that is turned away again and again is told of and kept', async () => {
    const words = 'there are 256 unfinished uploads of this token; allowed are 256: finish some or delete them';
    const bytes = groom_with('turned away');
    await with_page(daemon.address, async page => {
        let tries = 0;
        await page.route('**/v1/uploads', route => {
            ++tries;
            return route.fulfill(turned_away(words, 60));
        });
        await page.addInitScript(() => {
            const wait = setTimeout;
            globalThis.setTimeout = (act, ms) => wait(act, Math.min(ms, 20)); // minutes in all
        });
        await page.goto(`${daemon.address}/#/models`);
        const file = { name: 'away.hair', mimeType: '', buffer: bytes };
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await page.locator('.job[data-phase=failed] [role=alert]', { hasText: words }).waitFor();
        assert.equal(tries, 11); // after each of ten pauses, and at first
        await page.unrouteAll({ behavior: 'wait' });
        await page.reload(); // which goes on with what is kept
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.equal((await fetch(`${daemon.address}/v1/models/${sha256(bytes)}`)).status, 200);
    });
});

test('a file that the service has is not sent again', async () => {
    await with_page(daemon.address, async page => {
        const sent = [];
        page.on('request', request => {
            if (request.url().includes('/v1/uploads')) sent.push(request.url());
        });
        await page.goto(`${daemon.address}/#/models`);
        await page.locator('.drop-zone input[type=file]').setInputFiles(join(sample, 'groom.hair'));
        await page.getByText('the service had it already: nothing was sent').waitFor();
        assert.deepEqual(sent, []);
    });
});

test('what is no environment is refused in words', async () => {
    await with_page(daemon.address, async page => {
        await page.goto(`${daemon.address}/#/environments`);
        await page
            .locator('.drop-zone input[type=file]')
            .setInputFiles({ name: 'notes.hdr', mimeType: '', buffer: Buffer.from('shopping list') });
        const job = page.locator('.job[data-phase=failed]');
        await job.waitFor();
        assert.match(await job.locator('[role=alert]').innerText(), /sha256:[0-9a-f]{64}/); // not where it lies
    });
});

test('hostile names are text', async () => {
    const hostile = '<img src=x onerror="document.title=1">&lt;script&gt;.hdr';
    const evil_note = '<svg onload=alert(1)>';
    await with_page(daemon.address, async page => {
        page.on('dialog', () => assert.fail('a script of a name ran'));
        await page.goto(`${daemon.address}/#/environments`);
        await page
            .locator('.drop-zone input[type=file]')
            .setInputFiles({ name: hostile, mimeType: '', buffer: readFileSync(join(sample, 'overcast.hdr')) });
        await page.locator('.card h3', { hasText: hostile }).waitFor();
        assert.equal(await page.locator('.job strong').innerText(), hostile);
        assert.equal(await page.locator('img[src=x], svg[onload]').count(), 0);
        const card = page.locator('.card', { has: page.locator('h3', { hasText: hostile }) });
        await card.getByText('Name it').click();
        const suggestion = await card.getByLabel('Name', { exact: false }).first().inputValue();
        assert.match(suggestion, /^[A-Za-z0-9._-]+$/);
        await card.getByLabel('Note').fill(evil_note);
        await card.getByRole('button', { name: 'Put the name here' }).click();
        await page.locator('.card .names a', { hasText: suggestion }).click();
        await page.locator('td', { hasText: evil_note }).waitFor();
        assert.equal(await page.locator('main svg').count(), 0);
    });
});

test('a hair model that calls itself a script is text', async () => {
    const info = '<script>alert(1)</script>';
    const bytes = groom_with(info);
    await with_page(daemon.address, async page => {
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

test('a name gets a new version, shows what followed the old one, and that is baked again in one step', async () => {
    await put_name('environment', 'stage/sunset', sky);
    const { request } = await daemon.json(`/v1/bakes/${bake}`);
    const irradiance = { ...request.irradiance, specular_maps: 4 }; // a bake of its own: the first one asked by digest
    await daemon.finished(
        (await daemon.post('/v1/bakes', { ...request, irradiance, environment: 'name:stage/sunset' })).id,
    );
    const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
    await with_page(daemon.address, async page => {
        await page.goto(`${daemon.address}/#/names/environment/stage/sunset`);
        await page.getByText('1 bake asked for this name, 0 of them for an older version.').waitFor();
        await page.getByLabel('File').selectOption(studio);
        await page.getByRole('button', { name: 'Put as version 2' }).click();
        await page.getByText('1 bake asked for this name, 1 of them for an older version.').waitFor();
        assert.match(await page.locator('#forecast').innerText(), /Reused\s+1 transmittance, 0/);
        await page.getByRole('button', { name: /Bake with the newest version/ }).click();
        await page.getByText('All 1 have ended.').waitFor();
        const { bakes } = await daemon.json('/v1/bakes?name=stage%2Fsunset');
        assert.equal(bakes[0].environment, studio);
        await check_with_axe(page, 'batch');
        // The older bake is still there; that it was baked again is told.
        await page.goto(`${daemon.address}/#/names/environment/stage/sunset`);
        await page.getByText('2 bakes asked for this name, 1 of them for an older version.').waitFor();
        await page.getByRole('button', { name: 'Show 1 bake' }).waitFor();
        assert.match(await page.locator('#forecast').innerText(), /Done already\s+1/);
    });
});

test('a mesh is sent, gets a name and a new version, and what followed the old one is baked again', async () => {
    const head = join(sample, 'head.obj');
    const other = join(sample, 'other.obj');
    writeFileSync(other, `${readFileSync(head, 'utf8')}\n# the same head with another digest\n`);
    await with_page(daemon.address, async page => {
        await page.goto(`${daemon.address}/#/meshes`);
        await page.getByText('No mesh has a name yet.').waitFor();
        const send_and_name = async (file, path) => {
            await page.locator('.drop-zone input[type=file]').setInputFiles(file);
            await page.getByRole('textbox', { name: 'Name' }).fill(path);
            await page.getByRole('button', { name: 'Put the name here' }).click();
        };
        await send_and_name(head, 'heads/round');
        await page.getByRole('link', { name: 'heads/round' }).click();
        await page.getByText('0 bakes asked for this name').waitFor();
        const { request } = await daemon.json(`/v1/bakes/${bake}`);
        await put_name('environment', 'stage/still', sky);
        const by_names = { environment: 'name:stage/still', occluder: 'name:heads/round' };
        const { id } = await daemon.post('/v1/bakes', { ...request, ...by_names });
        await daemon.finished(id);
        await put_name('environment', 'stage/still', await daemon.add('environment', join(sample, 'studio.hdr')));
        await page.goto(`${daemon.address}/#/meshes`);
        await send_and_name(other, 'heads/round');
        await page.getByRole('cell', { name: '2', exact: true }).waitFor();
        await page.getByRole('link', { name: 'heads/round' }).click();
        await page.getByText('1 bake asked for this name, 1 of them for an older version.').waitFor();
        await page.getByRole('button', { name: 'Bake 1 bake with version 2' }).click();
        await page.getByRole('heading', { name: 'Bakes' }).waitFor();
        const { bakes } = await daemon.json('/v1/bakes?name=heads%2Fround');
        assert.deepEqual(bakes.map(one => one.names.occluder.version).sort(), [1, 2]);
        for (const { environment, names } of bakes) {
            assert.equal(environment, sky); // only the mesh is another
            assert.deepEqual(names.environment, { path: 'stage/still', version: 1 });
        }
    });
});

test('a bake that fails says why, and another can be cancelled from the queue', async () => {
    const dark = await daemon.add('environment', join(sample, 'overcast.hdr'));
    // The model has a width, so that strand.width is none; a mesh that is no OBJ fails the worker.
    const junk = Buffer.from('no mesh at all');
    await fetch(`${daemon.address}/v1/blobs/${sha256(junk)}`, { method: 'PUT', body: junk });
    const failing = await daemon.post('/v1/bakes', {
        hair: `sha256:${groom}`,
        environment: `sha256:${dark}`,
        occluder: `sha256:${sha256(junk)}`,
    });
    await with_page(daemon.address, async page => {
        await page.goto(`${daemon.address}/#/bakes/${failing.id}`);
        await page.getByRole('heading', { name: 'Why it failed' }).waitFor();
        assert.match(await page.locator('[role=alert] p').innerText(), /sha256:[0-9a-f]{64}/);
        await check_with_axe(page, 'failed bake');
        // Traced with the most directions: some minutes of work.
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
    await with_page(daemon.address, async page => {
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

test('the form refuses what the schema does not allow and says what is', async () => {
    await with_page(daemon.address, async page => {
        const posts = [];
        page.on('request', request => request.method() === 'POST' && posts.push(request.url()));
        await page.goto(`${daemon.address}/#/bake?environment=${sky}`);
        await page.getByText('Irradiance', { exact: true }).click();
        await page.getByLabel('Face size').fill('3');
        await page.getByRole('button', { name: 'Bake', exact: true }).click();
        await page.getByText('Face size is 3; allowed is 4 to 256, whole.').waitFor();
        assert.equal(await page.getByLabel('Face size').getAttribute('aria-invalid'), 'true');
        assert.deepEqual(posts, []);
    });
});

test('with tokens the page asks for one, takes the right one only, and forgets it on signing out', async () => {
    const token = 'a-token-of-this-test';
    const locked = await Daemon.start({ token });
    try {
        await with_page(locked.address, async page => {
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
        });
    } finally {
        await locked.stop();
    }
});

test('navigation moves the focus to the heading and tells the title', async () => {
    await with_page(daemon.address, async page => {
        await page.goto(daemon.address);
        await page.locator('.card').first().waitFor();
        for (let i = 0; i < 4; ++i) await page.keyboard.press('Tab'); // skip link, hairbake, Environments, Models
        await page.keyboard.press('Enter');
        await page.getByRole('heading', { level: 1, name: 'Hair models' }).waitFor();
        await page.waitForFunction(() => document.activeElement?.tagName === 'H1');
        assert.equal(await page.title(), 'Hair models · hairbake');
    });
});

test('the policy stops a script that stands in a page', async () => {
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

async function open_form(page, query = '') {
    await page.goto(`${daemon.address}/#/bake${query}`);
    await page.getByRole('button', { name: 'Bake', exact: true }).waitFor();
}

const request_of_form = async page => JSON.parse(await page.locator('form pre').textContent());

test('numbers are taken as they are typed', async () => {
    await with_page(daemon.address, async page => {
        await open_form(page);
        await page.evaluate(() => document.querySelectorAll('details.stage').forEach(one => (one.open = true)));
        const type = async (field, text) => {
            await field.fill('');
            await field.pressSequentially(text);
            assert.equal(await field.inputValue(), text);
        };
        await type(page.getByLabel(/exponent$/i), '10.05');
        await type(page.getByLabel('Rotation, degrees, X'), '-0.5');
        await type(page.getByLabel(/^Tint.*, R$/), '0.02');
        const { fiber, environment_settings } = in_new_places(await request_of_form(page));
        assert.deepEqual(fiber, { kajiya_kay: { exponent: 10.05 } });
        assert.deepEqual(environment_settings, { rotation_deg: [-0.5, 0, 0], tint: [0.02, 1, 1] });
        await page.getByLabel('Preset').selectOption('draft'); // what it sets replaces what was typed
        assert.equal(await page.getByLabel(/^Tint.*, R$/).inputValue(), '1');
    });
});

test('a stage of the form stays open while one types in it', async () => {
    await with_page(daemon.address, async page => {
        await open_form(page);
        await page.getByText('Irradiance', { exact: true }).click();
        const size = page.getByLabel('Face size');
        await size.fill('3');
        await page.getByText('Irradiance: 1 changed, 1 to correct').waitFor();
        await size.press('End');
        await size.pressSequentially('2');
        await page.getByText('Irradiance: 1 changed', { exact: true }).waitFor();
        assert.ok(await size.isVisible());
        assert.ok(await size.evaluate(field => field === document.activeElement));
        await page.getByText('Irradiance: 1 changed', { exact: true }).click();
        await size.waitFor({ state: 'hidden' });
    });
});

test('a bake asked for in the form by name follows the name to its new version', async () => {
    const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
    await with_page(daemon.address, async page => {
        await page.goto(`${daemon.address}/#/environments`);
        const card = page.locator(`.card[data-id="${sky}"]`);
        await card.getByText('Name it').click();
        await card.getByLabel('Name').first().fill('stage/dawn');
        await card.getByRole('button', { name: 'Put the name here' }).click();
        await card.getByRole('link', { name: 'stage/dawn', exact: true }).waitFor();
        await card.getByRole('button', { name: /^Bake with/ }).click();
        await page.locator(`input[type=radio][value="${groom}"]`).check();
        await page.getByLabel('Preset').selectOption('draft');
        const by = page.getByLabel('Environment: asked for by');
        assert.equal((await request_of_form(page)).environment, 'name:stage/dawn@1');
        await by.selectOption('this file');
        assert.equal((await request_of_form(page)).environment, `sha256:${sky}`);
        await by.selectOption('name:stage/dawn@1');
        await page.getByRole('button', { name: 'Bake', exact: true }).click();
        await page.waitForURL(/#\/bakes\/[0-9a-f]{64}$/);
        await daemon.finished(page.url().split('#/bakes/')[1]);
        await page.goto(`${daemon.address}/#/names/environment/stage/dawn`);
        await page.getByLabel('File').selectOption(studio);
        await page.getByRole('button', { name: 'Put as version 2' }).click();
        await page.getByText('1 bake asked for this name, 1 of them for an older version.').waitFor();
        await page.getByRole('button', { name: /Bake with the newest version/ }).waitFor();
    });
});

test('the form bakes the file that was picked, also where its name has moved on since', async () => {
    const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
    await put_name('environment', 'stage/noon', sky);
    await with_page(daemon.address, async page => {
        await open_form(page);
        await page.locator(`input[type=radio][value="${sky}"]`).check();
        await page.locator(`input[type=radio][value="${groom}"]`).check();
        await page.getByLabel('Environment: asked for by').selectOption('name:stage/noon@1');
        await put_name('environment', 'stage/noon', studio);
        await page.getByRole('button', { name: 'Bake', exact: true }).click();
        await page.waitForURL(/#\/bakes\/[0-9a-f]{64}$/);
        const address = `/v1/bakes/${page.url().split('#/bakes/')[1]}`;
        const { environment, names } = await daemon.json(address);
        assert.equal(environment, sky);
        assert.deepEqual(names.environment, { path: 'stage/noon', version: 1 });
        await daemon.json(address, { method: 'DELETE' });
    });
});

test('the form asks again after a refusal, which may have passed', async () => {
    const refusal = { detail: 'hair is not stored; send it first', field: 'hair' };
    await with_page(daemon.address, async page => {
        let asked = 0;
        await page.route('**/v1/bakes', route => {
            if (++asked > 2) return route.fulfill({ status: 202, json: { id: bake, state: 'queued' } });
            return route.fulfill({ status: 422, contentType: 'application/problem+json', json: refusal });
        });
        await open_form(page, `?environment=${sky}&hair=${groom}`);
        const bake_button = page.getByRole('button', { name: 'Bake', exact: true });
        const problem = page.locator('#fault-hair', { hasText: refusal.detail });
        await bake_button.click();
        await problem.waitFor();
        await page.getByLabel('Preset').selectOption('draft');
        await problem.waitFor({ state: 'detached' });
        await bake_button.click();
        await problem.waitFor();
        await bake_button.click();
        await page.waitForURL(new RegExp(`#/bakes/${bake}$`));
        assert.equal(asked, 3);
    });
});

test('of more bakes than a list holds the first ones are shown, and the service finds the others itself', async () => {
    await put_name('environment', 'stage/crowd', sky);
    await put_name('environment', 'stage/crowd', await daemon.add('environment', join(sample, 'studio.hdr')));
    const { bakes } = await daemon.json('/v1/bakes?state=done&limit=1');
    const names = { environment: { path: 'stage/crowd', version: 1 } };
    const crowd = Array.from({ length: 1000 }, (_, i) => ({ ...bakes[0], id: `${i}`.padStart(64, '0'), names }));
    await with_page(daemon.address, async page => {
        const asked = [];
        await page.route('**/v1/bakes?name=*', route => {
            asked.push(new URL(route.request().url()).searchParams.get('limit'));
            return route.fulfill({ json: { bakes: crowd, next: '1' } });
        });
        const again = page.waitForRequest(request => request.url().includes('/v1/rebakes'));
        await page.goto(`${daemon.address}/#/names/environment/stage/crowd`);
        await page.getByText('At least 1,000 bakes asked for this name, 1000 of them for an older version.').waitFor();
        await page.getByText('Only the first 1,000 are shown').waitFor();
        assert.deepEqual(asked, ['1000']);
        assert.deepEqual((await again).postDataJSON(), { environment: 'name:stage/crowd', name: 'stage/crowd' });
    });
});

test('a bake does not begin before its mesh is sent', async () => {
    const file = join(sample, 'large.obj');
    writeFileSync(file, `${readFileSync(join(sample, 'head.obj'), 'utf8')}\n${'# room\n'.repeat(2e6)}`);
    await with_page(daemon.address, async page => {
        const posts = [];
        page.on('request', request => request.url().endsWith('/v1/bakes') && posts.push(request.method()));
        await open_form(page, `?environment=${sky}`);
        await page.locator(`input[type=radio][value="${groom}"]`).check();
        await page.getByText('Meshes and priority').click();
        await throttle(page, slow);
        await page.getByLabel('Send an OBJ file as occluder').setInputFiles(file);
        await page.getByRole('button', { name: 'Bake', exact: true }).click();
        const occluder = page.getByRole('combobox', { name: 'Occluder' });
        await page.locator('.problem', { hasText: 'large.obj is still being sent.' }).waitFor();
        assert.equal(await occluder.getAttribute('aria-invalid'), 'true');
        assert.deepEqual(posts, []);
        await throttle(page, -1);
        await page.locator('.problem').waitFor({ state: 'detached' });
        assert.equal((await request_of_form(page)).occluder, `sha256:${sha256(readFileSync(file))}`);
    });
});

test('Cancel ends an upload here and on the service, and the next file goes on', async () => {
    const [file, next] = [large_groom(13), large_groom(14)];
    await with_page(daemon.address, async page => {
        const uploads = [];
        page.on('request', request => request.method() === 'PATCH' && uploads.push(request.url()));
        await send_slowly(page, [file, next]);
        await throttle(page, 1e5); // however long the click takes on a busy machine, the file is not whole by then
        await page.getByRole('button', { name: 'Cancel' }).first().click();
        await throttle(page, -1);
        await page.locator('.job[data-phase=stored]').waitFor();
        await assert_stored(next);
        assert.equal(await page.locator('.job').count(), 1);
        const head = async () =>
            (await fetch(uploads[0], { method: 'HEAD', headers: { 'Tus-Resumable': '1.0.0' } })).status;
        for (const end = Date.now() + 10000; (await head()) === 200 && Date.now() < end;)
            await page.waitForTimeout(100);
        assert.ok([404, 410].includes(await head()), `the upload is still there: ${await head()}`);
        assert.equal((await fetch(`${daemon.address}/v1/models/${sha256(readFileSync(file))}`)).status, 404);
    });
});

test('Cancel before anything is sent keeps it from being sent', async () => {
    await with_page(daemon.address, async page => {
        const sent = [];
        page.on('request', request => request.url().includes('/v1/uploads') && sent.push(request.method()));
        let asked, cancelled;
        const question = new Promise(resolve => (asked = resolve));
        const cancel = new Promise(resolve => (cancelled = resolve));
        await page.route('**/v1/blobs/*', async route => {
            asked();
            await cancel;
            await route.continue().catch(() => {}); // the page has taken the question back
        });
        await page.goto(`${daemon.address}/#/environments`);
        const file = { name: 'never.hdr', mimeType: '', buffer: Buffer.from('never sent') };
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await question;
        await page.getByRole('button', { name: 'Cancel: never.hdr' }).click();
        await page.locator('.job').waitFor({ state: 'detached' });
        cancelled();
        await page.unrouteAll({ behavior: 'wait' });
        await page.locator('.drop-zone input[type=file]').setInputFiles(join(sample, 'sky.hdr'));
        await page.getByText('the service had it already: nothing was sent').waitFor(); // the queue goes on
        assert.deepEqual(sent, []);
    });
});

test('a second tab leaves an upload to the first one until that is closed', async () => {
    const file = large_groom(15);
    await with_page(daemon.address, async (page, context) => {
        let begun;
        const first_piece = new Promise(resolve => (begun = resolve));
        await page.route('**/v1/uploads/*', route => {
            if (Number(route.request().headers()['upload-offset']) > 0) begun(); // the second piece never arrives
            else route.continue();
        });
        await page.goto(`${daemon.address}/#/models`);
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await first_piece;
        const other = await context.newPage();
        const offsets = watch_patches(other);
        await other.goto(`${daemon.address}/#/models`);
        await other.locator('.card').first().waitFor();
        await other.waitForTimeout(500);
        assert.equal(await other.locator('.job').count(), 0);
        assert.deepEqual(offsets, []);
        assert.equal(await page.locator('.job[data-phase=sending]').count(), 1);
        await page.goto('about:blank'); // closing would first let the piece pass that is held here
        await other.locator('.job[data-phase=stored]').waitFor({ timeout: patience_ms });
        assert.ok(offsets.at(0) > 0, `the first PATCH began at ${offsets.at(0)}`);
        await assert_stored(file);
    });
});

test('a file is sent also where the browser has no room to remember it', async () => {
    const bytes = groom_with('one more groom');
    await with_page(daemon.address, async page => {
        await page.goto(`${daemon.address}/#/models`);
        await page.evaluate(() => {
            for (let size = 1 << 22; size >= 1; size /= 2)
                try {
                    for (let i = 0; ; ++i) localStorage.setItem(`filler ${size} ${i}`, 'x'.repeat(size));
                } catch {
                    // as much of it as there is room for
                }
        });
        const file = { name: 'more.hair', mimeType: '', buffer: bytes };
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.equal((await fetch(`${daemon.address}/v1/models/${sha256(bytes)}`)).status, 200);
    });
});

test('a refused form brings the focus to the first fault, which is read with its field', async () => {
    await with_page(daemon.address, async page => {
        await open_form(page);
        const words_of = field =>
            field.evaluate(one =>
                one
                    .getAttribute('aria-describedby')
                    .split(' ')
                    .map(id => document.getElementById(id).textContent)
                    .join(' '),
            );
        const focused = page.locator(':focus');
        const bake_button = page.getByRole('button', { name: 'Bake', exact: true });
        await bake_button.click();
        await page.waitForFunction(() => document.activeElement.name === 'picker-Hair model');
        assert.match(await words_of(page.getByRole('radiogroup', { name: 'Hair model' })), /or one of each is needed/);
        await check_with_axe(page, 'refused form');
        await page.locator(`input[type=radio][value="${sky}"]`).check();
        await page.getByText('Irradiance', { exact: true }).click();
        await page.getByRole('button', { name: 'Add a light' }).click();
        const part = page.getByLabel('Light 1, irradiance, G');
        await part.fill('-1');
        assert.equal(await part.getAttribute('aria-invalid'), 'true');
        assert.equal(await page.getByLabel('Light 1, irradiance, R').getAttribute('aria-invalid'), null);
        assert.match(await words_of(part), /Directional lights.*is -1; allowed is 0 to/s);
        await page.getByText('Irradiance: 1 changed, 1 to correct').click();
        await part.waitFor({ state: 'hidden' });
        await bake_button.click();
        await part.waitFor();
        assert.equal(await focused.getAttribute('aria-label'), 'Light 1, irradiance, G');
    });
});

async function check_with_axe(page, name) {
    await page.evaluate(axe); // by the debugger, which the page's policy does not bind
    const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
    const words = violations.flatMap(({ id, help, nodes }) =>
        nodes.map(({ html }) => `${name}: ${id}: ${help}: ${html.slice(0, 160)}`),
    );
    assert.deepEqual(words, []);
}

// What to scroll to on each page, and what it shows once it is whole.
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
            await with_page(
                daemon.address,
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
