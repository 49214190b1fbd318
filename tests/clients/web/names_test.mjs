// Names and their versions in the page: which bakes use them, and baking those again. The real daemon, in Chromium.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { PageSession, check_with_axe, request_of_form } from './page_session.mjs';

let session, daemon, sample, groom, sky, bake;

before(async () => {
    session = await PageSession.start();
    ({ daemon, sample, groom, sky, bake } = session);
});
after(() => session?.stop());

test('a name gets a new version, lists the bakes of the old one, and bakes them again in one step', async () => {
    await session.put_name('environment', 'stage/sunset', sky);
    const { request } = await daemon.json(`/v1/bakes/${bake}`);
    const irradiance = { ...request.irradiance, specular_maps: 4 }; // another bake: the first one refers to a digest
    await daemon.finished(
        (await daemon.post('/v1/bakes', { ...request, irradiance, environment: 'name:stage/sunset' })).id,
    );
    const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/names/environment/stage/sunset`);
        await page.getByText('1 bake uses this name, 0 of them in an older version.').waitFor();
        await page.getByLabel('File').selectOption(studio);
        await page.getByRole('button', { name: 'Put as version 2' }).click();
        await page.getByText('1 bake uses this name, 1 of them in an older version.').waitFor();
        assert.match(await page.locator('#forecast').innerText(), /Reused\s+1 transmittance, 0/);
        await page.getByRole('button', { name: /Bake with the newest version/ }).click();
        await page.getByText('All 1 have ended.').waitFor();
        const { bakes } = await daemon.json('/v1/bakes?name=stage%2Fsunset');
        assert.equal(bakes[0].environment, studio);
        await check_with_axe(page, 'batch');
        // The older bake is still listed, and the forecast counts it as done already.
        await page.goto(`${daemon.address}/#/names/environment/stage/sunset`);
        await page.getByText('2 bakes use this name, 1 of them in an older version.').waitFor();
        await page.getByRole('button', { name: 'Show 1 bake' }).waitFor();
        assert.match(await page.locator('#forecast').innerText(), /Done already\s+1/);
    });
});

test('a mesh is sent, gets a name and a new version, and the bakes of the old one are baked again', async () => {
    const head = join(sample, 'head.obj');
    const other = join(sample, 'other.obj');
    writeFileSync(other, `${readFileSync(head, 'utf8')}\n# the same head with another digest\n`);
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/meshes`);
        await page.getByText('No mesh has a name yet.').waitFor();
        const send_and_name = async (file, path) => {
            await page.locator('.drop-zone input[type=file]').setInputFiles(file);
            await page.getByRole('textbox', { name: 'Name' }).fill(path);
            await page.getByRole('button', { name: 'Give this name' }).click();
        };
        await send_and_name(head, 'heads/round');
        await page.getByRole('link', { name: 'heads/round' }).click();
        await page.getByText('0 bakes use this name').waitFor();
        const { request } = await daemon.json(`/v1/bakes/${bake}`);
        await session.put_name('environment', 'stage/still', sky);
        const by_names = { environment: 'name:stage/still', occluder: 'name:heads/round' };
        const { id } = await daemon.post('/v1/bakes', { ...request, ...by_names });
        await daemon.finished(id);
        const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
        await session.put_name('environment', 'stage/still', studio);
        await page.goto(`${daemon.address}/#/meshes`);
        await send_and_name(other, 'heads/round');
        await page.getByRole('cell', { name: '2', exact: true }).waitFor();
        await page.getByRole('link', { name: 'heads/round' }).click();
        await page.getByText('1 bake uses this name, 1 of them in an older version.').waitFor();
        await page.getByRole('button', { name: 'Bake 1 bake with version 2' }).click();
        await page.getByRole('heading', { name: 'Bakes' }).waitFor();
        const { bakes } = await daemon.json('/v1/bakes?name=heads%2Fround');
        assert.deepEqual(bakes.map(one => one.names.occluder.version).sort(), [1, 2]);
        for (const { environment, names } of bakes) {
            assert.equal(environment, sky); // only the mesh differs
            assert.deepEqual(names.environment, { path: 'stage/still', version: 1 });
        }
    });
});

test('a bake of the form that refers to a name is baked again with its new version', async () => {
    const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/environments`);
        const card = page.locator(`.card[data-id="${sky}"]`);
        await card.getByText('Give a name').click();
        await card.getByLabel('Name').first().fill('stage/dawn');
        await card.getByRole('button', { name: 'Give this name' }).click();
        await card.getByRole('link', { name: 'stage/dawn', exact: true }).waitFor();
        await card.getByRole('button', { name: /^Bake with/ }).click();
        await page.locator(`input[type=radio][value="${groom}"]`).check();
        await page.getByLabel('Preset').selectOption('draft');
        const by = page.getByLabel('Environment: reference');
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
        await page.getByText('1 bake uses this name, 1 of them in an older version.').waitFor();
        await page.getByRole('button', { name: /Bake with the newest version/ }).waitFor();
    });
});

test('of more bakes than fit a list the first ones are shown, and the service finds the others itself', async () => {
    await session.put_name('environment', 'stage/crowd', sky);
    await session.put_name('environment', 'stage/crowd', await daemon.add('environment', join(sample, 'studio.hdr')));
    const { bakes } = await daemon.json('/v1/bakes?state=done&limit=1');
    const names = { environment: { path: 'stage/crowd', version: 1 } };
    const crowd = Array.from({ length: 1000 }, (_, i) => ({ ...bakes[0], id: `${i}`.padStart(64, '0'), names }));
    await session.with_page(async page => {
        const asked = [];
        await page.route('**/v1/bakes?name=*', route => {
            asked.push(new URL(route.request().url()).searchParams.get('limit'));
            return route.fulfill({ json: { bakes: crowd, next: '1' } });
        });
        const again = page.waitForRequest(request => request.url().includes('/v1/rebakes'));
        await page.goto(`${daemon.address}/#/names/environment/stage/crowd`);
        await page.getByText('At least 1,000 bakes use this name, 1000 of them in an older version.').waitFor();
        await page.getByText('Only the first 1,000 are shown').waitFor();
        assert.deepEqual(asked, ['1000']);
        assert.deepEqual((await again).postDataJSON(), { environment: 'name:stage/crowd', name: 'stage/crowd' });
    });
});
