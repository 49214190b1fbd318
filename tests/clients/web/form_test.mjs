// The form of a new bake: input, validation, refusals, focus. The real daemon, in Chromium.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { PageSession, check_with_axe, request_of_form, sha256, slow, throttle } from './page_session.mjs';

let session, daemon, sample, groom, sky, bake;

before(async () => {
    session = await PageSession.start();
    ({ daemon, sample, groom, sky, bake } = session);
});
after(() => session?.stop());

test('the form refuses what the schema does not allow and says what is', async () => {
    await session.with_page(async page => {
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

test('numbers are taken as they are typed', async () => {
    await session.with_page(async page => {
        await session.open_form(page);
        await page.evaluate(() => document.querySelectorAll('details.stage').forEach(one => (one.open = true)));
        const type = async (field, text) => {
            await field.fill('');
            await field.pressSequentially(text);
            assert.equal(await field.inputValue(), text);
        };
        await type(page.getByLabel('Kajiya-Kay: exponent'), '10.05');
        await type(page.getByLabel('Rotation, degrees, X'), '-0.5');
        await type(page.getByLabel(/^Tint.*, R$/), '0.02');
        const { outputs, ...request } = await request_of_form(page);
        assert.deepEqual(request, {
            fiber: { kajiya_kay: { exponent: 10.05 } },
            environment_settings: { rotation_deg: [-0.5, 0, 0], tint: [0.02, 1, 1] },
        });
        await page.getByLabel('Preset').selectOption('draft'); // its values replace what was typed
        assert.equal(await page.getByLabel(/^Tint.*, R$/).inputValue(), '1');
    });
});

test('a block of the form stays open while the user types in it', async () => {
    await session.with_page(async page => {
        await session.open_form(page);
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

test('the form bakes the file that was picked, also where its name has a new version since', async () => {
    const studio = await daemon.add('environment', join(sample, 'studio.hdr'));
    await session.put_name('environment', 'stage/noon', sky);
    await session.with_page(async page => {
        await session.open_form(page);
        await page.locator(`input[type=radio][value="${sky}"]`).check();
        await page.locator(`input[type=radio][value="${groom}"]`).check();
        await page.getByLabel('Environment: reference').selectOption('name:stage/noon@1');
        await session.put_name('environment', 'stage/noon', studio);
        await page.getByRole('button', { name: 'Bake', exact: true }).click();
        await page.waitForURL(/#\/bakes\/[0-9a-f]{64}$/);
        const address = `/v1/bakes/${page.url().split('#/bakes/')[1]}`;
        const { environment, names } = await daemon.json(address);
        assert.equal(environment, sky);
        assert.deepEqual(names.environment, { path: 'stage/noon', version: 1 });
        await daemon.json(address, { method: 'DELETE' });
    });
});

test('the form posts again after a refusal, whose reason may be gone', async () => {
    const refusal = { detail: 'hair is not stored; send it first', field: 'hair' };
    await session.with_page(async page => {
        let asked = 0;
        await page.route('**/v1/bakes', route => {
            if (++asked > 2) return route.fulfill({ status: 202, json: { id: bake, state: 'queued' } });
            return route.fulfill({ status: 422, contentType: 'application/problem+json', json: refusal });
        });
        await session.open_form(page, `?environment=${sky}&hair=${groom}`);
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

test('a bake does not begin before its mesh is sent', async () => {
    const file = join(sample, 'large.obj');
    writeFileSync(file, `${readFileSync(join(sample, 'head.obj'), 'utf8')}\n${'# room\n'.repeat(2e6)}`);
    await session.with_page(async page => {
        const posts = [];
        page.on('request', request => request.url().endsWith('/v1/bakes') && posts.push(request.method()));
        await session.open_form(page, `?environment=${sky}`);
        await page.locator(`input[type=radio][value="${groom}"]`).check();
        await page.getByText('Meshes and priority').click();
        await throttle(page, slow);
        await page.getByLabel('Send a mesh file as occluder').setInputFiles(file);
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

test('a refused form moves the focus to the first fault, whose message belongs to its field', async () => {
    await session.with_page(async page => {
        await session.open_form(page);
        const description_of = field =>
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
        const models = page.getByRole('radiogroup', { name: 'Hair model' });
        assert.match(await description_of(models), /or one of each is needed/);
        await check_with_axe(page, 'refused form');
        await page.locator(`input[type=radio][value="${sky}"]`).check();
        await page.getByText('Irradiance', { exact: true }).click();
        await page.getByRole('button', { name: 'Add a light' }).click();
        const part = page.getByLabel('Light 1, irradiance, G');
        await part.fill('-1');
        assert.equal(await part.getAttribute('aria-invalid'), 'true');
        assert.equal(await page.getByLabel('Light 1, irradiance, R').getAttribute('aria-invalid'), null);
        assert.match(await description_of(part), /Directional lights.*is -1; allowed is 0 to/s);
        await page.getByText('Irradiance: 1 changed, 1 to correct').click();
        await part.waitFor({ state: 'hidden' });
        await bake_button.click();
        await part.waitFor();
        assert.equal(await focused.getAttribute('aria-label'), 'Light 1, irradiance, G');
    });
});
