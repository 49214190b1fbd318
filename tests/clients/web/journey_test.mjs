// An artist's way through the whole page, with the real daemon: upload, bake, result, viewer, re-bake. Pictures of
// every page are written to the folder HAIRBAKE_SCREENSHOTS.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { from_half } from '../../../clients/web/viewer/half_float.js';
import { launch, open_page, tests } from './browser.mjs';
import { Daemon, hairbake, patience_ms } from './daemon.mjs';

const screenshots = process.env.HAIRBAKE_SCREENSHOTS ?? resolve(tests, '../build/screenshots');
const real_maps = join(process.env.HAIRBAKE_SHARED_DATA ?? resolve(tests, '../../shared/data'), 'env');

let daemon, browser, page, faults, sample;

before(async () => {
    mkdirSync(screenshots, { recursive: true });
    sample = mkdtempSync(join(tmpdir(), 'hairbake-sample-'));
    hairbake('sample', sample, '--vertices', '60000', '--map-width', '256');
    daemon = await Daemon.start();
    browser = await launch();
    ({ page, faults } = await open_page(browser, daemon.address, { acceptDownloads: true }));
    page.setDefaultTimeout(patience_ms);
});

after(async () => {
    await browser?.close();
    await daemon?.stop();
    rmSync(sample, { recursive: true, force: true });
});

const forms = [
    ['light_1280x720', { width: 1280, height: 720 }, 'light', 1],
    ['dark_1280x720', { width: 1280, height: 720 }, 'dark', 1],
    ['tablet_768x1024', { width: 768, height: 1024 }, 'light', 1],
    ['zoom_200', { width: 640, height: 360 }, 'light', 2], // what 200 % of 1280x720 leaves
];

/** Pictures of the page in every form. None may scroll sideways (WCAG 1.4.10 asks that down to 320 pixels). */
async function keep_pictures(name) {
    for (const [form, size, colorScheme] of forms) {
        await page.setViewportSize(size);
        await page.emulateMedia({ colorScheme });
        await page.evaluate(() => new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn))));
        const beyond = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(beyond <= 0, `${name} in ${form} is ${beyond} pixels too wide`);
        await page.screenshot({ path: join(screenshots, `${name}_${form}.png`), fullPage: true });
    }
    await page.setViewportSize(forms[0][1]);
    await page.emulateMedia({ colorScheme: 'light' });
}

async function upload(section, file) {
    await page.getByRole('link', { name: section, exact: true }).click();
    await page.getByRole('heading', { level: 1, name: section === 'Models' ? 'Hair models' : section }).waitFor();
    await page.locator('.drop-zone input[type=file]').setInputFiles(file);
    await page.locator('.card h3', { hasText: basename(file) }).waitFor();
}

const bake_of_page = () => page.url().split('#/bakes/')[1];

async function wait_until_done() {
    await page.locator('.state-done').first().waitFor();
    return daemon.json(`/v1/bakes/${bake_of_page()}`);
}

/** A photographed map if one is installed, else the generated sky. */
function a_real_map() {
    const found = existsSync(real_maps)
        ? readdirSync(real_maps)
              .filter(name => name.endsWith('.hdr'))
              .sort()
        : [];
    return found.length ? join(real_maps, found[0]) : join(sample, 'sky.hdr');
}

let first_bake;

test('environments and a model are sent and shown with their facts', async () => {
    await page.goto(daemon.address);
    await upload('Environments', a_real_map());
    await upload('Environments', join(sample, 'studio.hdr'));
    await page.locator('.card', { hasText: 'studio.hdr' }).getByText('Facts').click();
    assert.match(await page.locator('.card', { hasText: 'studio.hdr' }).innerText(), /256 x 128 lat-long/);
    await keep_pictures('environments');
    await upload('Models', join(sample, 'groom.hair'));
    assert.match(await page.locator('.card').innerText(), /60,000 vertices/); // --vertices 60000
    await keep_pictures('models');
    await page.getByRole('link', { name: 'Meshes', exact: true }).click();
    await page.getByRole('heading', { level: 1, name: 'Meshes' }).waitFor();
    await page.locator('.drop-zone input[type=file]').setInputFiles(join(sample, 'head.obj'));
    await page.getByRole('textbox', { name: 'Name' }).fill('heads/sample');
    await keep_pictures('mesh_to_name');
    await page.getByRole('button', { name: 'Give this name' }).click();
    await page.getByRole('link', { name: 'heads/sample' }).waitFor();
    await keep_pictures('meshes');
    await page.getByRole('link', { name: 'heads/sample' }).click();
    await page.locator('#followers').waitFor();
    await keep_pictures('name');
});

test('the form posts a bake, which is watched to its end', async () => {
    await page.getByRole('link', { name: 'New bake' }).click();
    await page.getByRole('radio', { name: /groom.hair/ }).check();
    await page.getByRole('radio', { name: new RegExp(basename(a_real_map())) }).check();
    await page.getByLabel('Preset').selectOption('draft');
    await page.getByText('Irradiance', { exact: true }).click();
    await page.getByLabel('Specular maps').fill('9');
    await page.getByText('Irradiance: 1 changed').waitFor();
    await page.getByText('The request as JSON').click();
    const shown = JSON.parse(await page.locator('form pre').innerText());
    assert.equal(shown.irradiance.specular_maps, 9);
    assert.equal(shown.transmittance.directions, 32); // config/presets/draft.json
    await keep_pictures('bake');
    await page.getByRole('button', { name: 'Bake', exact: true }).click();
    await page.waitForURL(/#\/bakes\/[0-9a-f]{64}$/);
    await page.getByRole('region', { name: 'Progress' }).waitFor();
    await page.screenshot({ path: join(screenshots, 'progress.png') });
    const bake = await wait_until_done();
    first_bake = bake.id;
    assert.equal(bake.request.irradiance.specular_maps, 9);
    assert.ok(bake.request.outputs.includes('raw'));
});

test('the result shows maps, the value under the pointer, histogram and error bars', async () => {
    const picture = page.locator('canvas.map-canvas');
    await picture.waitFor();
    // +Z fills the net's second column and second row: its middle is at 3/8 and 1/2 of the picture; n = 8 in a draft,
    // so that a hair to the right and below lies in column 4, row 4.
    const box = await picture.boundingBox();
    await picture.hover({ position: { x: box.width * 0.375 + 3, y: box.height * 0.5 + 3 } });
    await page.getByText('+Z, column 4, row 4').waitFor();
    const maps = await daemon.json(`/v1/bakes/${first_bake}/files/maps.json`);
    const reply = await fetch(`${daemon.address}/v1/bakes/${first_bake}/files/maps.f16`);
    const halves = new Uint16Array(await reply.arrayBuffer());
    const at = ((4 * 8 + 4) * 8 + 4) * 4; // face 4, row 4, column 4 of the first map
    const expected = [0, 1, 2].map(i => from_half(halves[at + i]) * maps.scale);
    const read = (await page.locator('#texel-value').innerText()).split(', ').map(Number);
    for (let i = 0; i < 3; ++i)
        assert.ok(Math.abs(read[i] - expected[i]) <= 1e-4 * expected[i], `${read}, not ${expected}`); // five digits

    const manifest = await daemon.json(`/v1/bakes/${first_bake}/files/manifest.json`);
    await page.locator('.histogram').scrollIntoViewIfNeeded(); // it is fetched when it is near the visible part
    const term = page.locator('.facts div', { hasText: 'Mean of A' }).locator('dd');
    // Half floats have 11 bits: the relative error of each A is at most 2^-12, and that of the mean too.
    assert.ok(
        Math.abs(Number(await term.innerText()) - manifest.transmittance.mean) < 1e-3 * manifest.transmittance.mean,
    );
    await page.locator('.chart canvas').waitFor();
    assert.match(await page.locator('main').innerText(), /A against traced strands, RMSE/);
    await keep_pictures('result');

    await page.getByRole('radio', { name: 'Specular' }).check();
    await page.getByRole('radio', { name: 'Lat-long' }).check();
    await page.locator('#theta').fill('2');
    await page.getByText("Specular, θ' = 45°", { exact: true }).waitFor(); // 2 pi / 8
    await keep_pictures('result_specular');
});

test('a downloaded file has the digest that the service states', async () => {
    const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('link', { name: 'transmittance.npy' }).click(),
    ]);
    const bytes = readFileSync(await download.path());
    const { files } = await daemon.json(`/v1/bakes/${first_bake}`);
    assert.equal(download.suggestedFilename(), 'transmittance.npy');
    assert.equal(
        createHash('sha256').update(bytes).digest('hex'),
        files.find(({ name }) => name === 'transmittance.npy').sha256,
    );
});

test('the viewer turns the sky, and its light is baked', async () => {
    await page
        .getByRole('button', { name: 'See it on the hair' })
        .or(page.getByRole('link', { name: 'See it on the hair' }))
        .click();
    await page.getByText(/Frame time: [0-9.]+ ms/).waitFor();
    const sky = basename(a_real_map());
    await page.locator('.viewer-captions', { hasText: `groom.hair under ${sky}, 9 specular maps` }).waitFor();
    await page.locator('label', { hasText: 'Turn about the vertical (Y)' }).locator('input').fill('30');
    await keep_pictures('viewer');
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    await page.getByRole('link', { name: 'open the new bake' }).waitFor();
    const { bakes } = await daemon.json('/v1/bakes?state=done');
    const turned = await daemon.json(`/v1/bakes/${bakes[0].id}`);
    assert.deepEqual(turned.request.environment_settings.rotation_deg, [0, 30, 0]);
    const fetched = [];
    page.on('request', request => fetched.push(basename(new URL(request.url()).pathname)));
    await page.getByRole('link', { name: 'compare it with this one' }).click();
    await page
        .locator('.viewer-captions span', { hasText: `groom.hair under ${sky}, 9 specular maps, sky turned by 30°` })
        .waitFor();
    assert.equal(await page.getByRole('slider', { name: 'Turn about the vertical (Y)' }).inputValue(), '30');
    assert.ok(fetched.includes('maps.f16'));
    assert.ok(!fetched.some(name => name.startsWith('strands')), 'the hair was there already');
    await page.screenshot({ path: join(screenshots, 'viewer_split.png') });
});

test('a set of bakes is baked again under another sky: its transmittance is reused', async () => {
    await page.getByRole('link', { name: 'Bakes', exact: true }).click();
    await page.locator('tbody tr').nth(1).waitFor();
    for (const box of await page.getByRole('checkbox').all()) await box.check();
    await keep_pictures('bakes');
    await page
        .getByRole('link', { name: /Re-bake 2 bakes/ })
        .or(page.getByRole('button', { name: /Re-bake 2 bakes/ }))
        .click();
    await page.getByRole('radio', { name: /studio.hdr/ }).check();
    // Both bakes have one groom and one set of settings: one transmittance. Their rotations differ: two sets of maps.
    await page.locator('#forecast').waitFor();
    assert.match(
        await page.locator('#forecast').innerText(),
        /Reused\s+1 transmittance, 0 sets.*\s+Computed\s+0 transmittances, 2 sets/,
    );
    await keep_pictures('rebake');
    await page.getByRole('button', { name: 'Re-bake 2 bakes' }).click();
    await page.getByText('All 2 have ended.').waitFor();
    await page.locator('tr .state-done').nth(1).waitFor();
    await keep_pictures('batch');
});

test('directional transmittance and bent cones of a real bake hide an added light, each in its way', async () => {
    const { request } = await daemon.json(`/v1/bakes/${first_bake}`);
    const transmittance = { ...request.transmittance, sh_bands: 3, bent_cone: true };
    const { id } = await daemon.post('/v1/bakes', { ...request, transmittance });
    await daemon.finished(id);
    const errors = [];
    page.on('console', message => message.type() === 'error' && errors.push(message.text()));
    await page.goto(`${daemon.address}/#/view/${id}`);
    await page.getByText(/Frame time: [0-9.]+ ms/).waitFor();
    await page.getByRole('slider', { name: 'Exposure' }).fill('-6'); // the light alone, nearly
    await page.getByRole('button', { name: 'Add a light' }).click();
    const pictures = new Set();
    const ways = ['Directional transmittance', 'Bent cone', 'A alone'];
    for (const way of ways) {
        await page.getByRole('combobox', { name: 'Hair blocks added lights by' }).selectOption(way);
        await page.evaluate(() => new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn))));
        const bytes = await page.locator('.viewer canvas').screenshot();
        pictures.add(bytes.toString('base64'));
        await page.screenshot({ path: join(screenshots, `viewer_light_${ways.indexOf(way)}.png`) });
    }
    assert.equal(pictures.size, ways.length, 'two ways look alike');
    assert.deepEqual(errors, []);
});

test('the page caused no fault on the way', () => {
    assert.deepEqual(faults, []);
});
