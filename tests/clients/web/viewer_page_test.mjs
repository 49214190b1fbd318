// The viewer's page in a browser, with a simulated service.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { bake_service, generator, random_maps, strand_files } from './raw_files.mjs';
import { json, open_browser, open_page, serve, stage } from './support.mjs';

const pictures = process.env.HAIRBAKE_SCREENSHOTS ?? join(tmpdir(), 'hairbake_web_pictures');
const axe = createRequire(new URL('../../npm/package.json', import.meta.url)).resolve('axe-core/axe.min.js');
const hostile = '<img src=x onerror=alert(1)>';

const html = `<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Viewer</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="light dark">
<link rel="stylesheet" href="/vendor/pico.css"></head>
<body><main class="container-fluid"><h1>Viewer</h1><div id="place"></div></main>
<script type="module" src="/mount.js"></script></body></html>`;
const mount = `import { html, render } from '/vendor/preact.js';
import { Api } from '/app/api.js';
import { ViewerPage } from '/viewer/viewer_page.js';
const place = document.querySelector('#place');
const api = new Api(() => (window.locked = true));
const show = () => {
    const [left, right] = location.hash.replace(/^#\\/(view\\/)?/, '').split('/');
    render(html\`<\${ViewerPage} left=\${left} right=\${right} api=\${api} />\`, place);
};
addEventListener('hashchange', show);
show();
window.unmount = () => render(null, place);`;

const sources = { strands: 'first', maps: 'second' }; // the older bakes whose files the new bake shares
const going = json({ id: 'new', state: 'running' });
let site, server, browser, page, posted, refusal;
let done, expired; // the view of the new bake; whether files are refused
let ordered; // the id of the bake that an order makes
let polls; // answers about the ordered bake; the last one is repeated

/** Curls around a ball, which is easy to recognise in a picture. */
function ball_of_hair(random) {
    const vertices = [],
        begin = [0];
    for (let s = 0; s < 400; s++) {
        const z = 1 - (2 * (s + 0.5)) / 400,
            azimuth = s * 2.399963,
            level = Math.sqrt(1 - z * z),
            curl = 6 * random();
        const out = [level * Math.cos(azimuth), z, level * Math.sin(azimuth)];
        for (let i = 0; i < 12; i++) {
            const r = 3 + 0.15 * i,
                turn = curl + 0.5 * i;
            vertices.push({
                position: [
                    r * out[0] + 0.1 * Math.cos(turn),
                    r * out[1] - 0.01 * i * i,
                    r * out[2] + 0.1 * Math.sin(turn),
                ],
                tangent: out,
                average: 0.2 + 0.07 * i,
                sh: [0.5 + 0.2 * i, out[1], out[2], out[0]],
                cone: [...out, 1.2],
            });
        }
        begin.push(vertices.length);
    }
    return strand_files(vertices, begin);
}

before(async () => {
    const random = generator(11),
        hair = ball_of_hair(random);
    const maps = (count, exponent = 64, scale = 1) => random_maps(random, 8, count, { scale, exponent }).files;
    // The first bake's request has the places of older bakes, the second one's the new ones.
    const request = { irradiance: { rotation_deg: [0, 30, 0], exposure_stops: 1, tint: [1, 1, 1], lights: [] } };
    const second_request = { environment_settings: { rotation_deg: [0, 10, 0] } };
    const names = { environment: { path: 'stage/dawn', version: 2 } };
    const bakes = bake_service({
        first: { files: { ...hair, ...maps(34) }, request, names },
        second: { files: { ...hair, ...maps(10, 20) }, request: second_request },
        dim: { files: { ...hair, ...maps(10, 64, 2 ** -20) } },
        unread: {
            files: { 'transmittance.npy': Buffer.alloc(1) },
            request: { ...request, outputs: ['npy'] },
            names: { hair: { path: 'heads/curly', version: 1 } },
        },
        bald: { files: { ...hair, ...maps(34) }, request: { hair: null } },
        broken: { files: { ...hair, ...maps(34), 'strands.bin': Buffer.alloc(100) } },
    });
    const view_of = id => JSON.parse(bakes('GET', `/v1/bakes/${id}`).body);
    const files = Object.entries(sources).flatMap(([kind, id]) =>
        view_of(id).files.filter(({ name }) => name.startsWith(kind)),
    );
    done = json({ ...view_of('first'), id: 'new', files });
    const answer = (method, path, body) => {
        if (path === '/') return { type: 'text/html', body: html };
        if (path === '/mount.js') return { type: 'text/javascript', body: mount };
        if (expired && path.includes('/files/')) return json({ detail: 'A token is needed.' }, 401);
        if (method === 'POST' && refusal) return json({ detail: refusal }, 422);
        if (method === 'POST') {
            posted.push(JSON.parse(body));
            return json({ id: ordered, state: 'queued' }, 202);
        }
        if (path === '/v1/bakes/new') return polls.length > 1 ? polls.shift() : polls[0];
        const shared = path.match(/^\/v1\/bakes\/new\/files\/(strands|maps)/);
        if (shared) return bakes(method, path.replace('new', sources[shared[1]]));
        return bakes(method, path);
    };
    mkdirSync(pictures, { recursive: true });
    site = stage();
    server = await serve(site.folder, answer);
    browser = await open_browser();
});
after(async () => {
    await browser?.close();
    await server?.close();
    site?.remove();
});
beforeEach(() => {
    posted = [];
    refusal = null;
    expired = false;
    ordered = 'new';
    polls = [going, done];
});
afterEach(async () => {
    const problems = page.problems.filter(problem => !/status of [45]\d\d/.test(problem)); // tests provoke those
    await page.close();
    assert.deepEqual(problems, [], "on the browser's console");
});

async function open(path, options) {
    page = await open_page(browser, options);
    await page.goto(`${server.origin}/#/${path}`);
    await page.waitForSelector('.viewer-captions, .viewer-problem');
    if (await page.$('.viewer-captions'))
        await page.waitForFunction(() => /ms/.test(document.querySelector('.viewer-note output').value));
}

/** Waits until frames have stopped coming, then gives the picture on the canvas as bytes. */
async function picture() {
    await page.evaluate(
        () => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 100)))),
    );
    return page.locator('.viewer canvas').screenshot();
}

const slider = label => page.getByRole('slider', { name: label });

test("Hair appears with the frame's time, and axe finds nothing wrong, light or dark", async () => {
    for (const colorScheme of ['light', 'dark']) {
        await open('first', { colorScheme });
        await page.getByRole('button', { name: 'Add a light' }).click();
        await page.screenshot({ path: join(pictures, `viewer_${colorScheme}.png`) });
        await page.evaluate(readFileSync(axe, 'utf8'));
        const { violations } = await page.evaluate(() => window.axe.run());
        assert.deepEqual(
            violations.map(({ id, nodes }) => `${id}: ${nodes[0].html}`),
            [],
        );
        if (colorScheme === 'light') await page.close();
    }
});

test('Arrow keys orbit, plus comes nearer, and F frames again', async () => {
    await open('first');
    await page.focus('.viewer canvas'); // the focus frame is in the picture
    const before = await picture();
    await page.keyboard.press('ArrowLeft');
    const turned = await picture();
    assert.ok(!turned.equals(before), 'the arrow key changed nothing');
    await page.keyboard.press('ArrowRight');
    assert.ok((await picture()).equals(before), 'back is not where it was');
    await page.keyboard.press('+');
    assert.ok(!(await picture()).equals(before), 'plus changed nothing');
    await page.keyboard.press('f');
    assert.ok((await picture()).equals(before), 'F did not frame');
});

test('Dragging orbits and the wheel changes the distance', async () => {
    await open('first');
    const before = await picture();
    await page.mouse.move(300, 300);
    await page.mouse.down();
    await page.mouse.move(360, 320, { steps: 3 });
    await page.mouse.up();
    const turned = await picture();
    assert.ok(!turned.equals(before), 'dragging changed nothing');
    await page.mouse.wheel(0, 200);
    assert.ok(!(await picture()).equals(turned), 'the wheel changed nothing');
});

test('Each choice of what is shown gives another picture, and two bakes stand side by side', async () => {
    await open('first/second');
    const seen = [await picture()];
    await page.screenshot({ path: join(pictures, 'viewer_split.png') });
    assert.match(
        await page.innerText('.viewer-captions'),
        /first, 33 specular maps, sky turned by 30°, \+1 stops\s+second, 9 specular maps, sky turned by 10°/,
    );
    await page.getByLabel('Split').selectOption('One picture');
    for (const part of ['Diffuse only', 'Specular only', 'A only', 'Diffuse and specular']) {
        await page.getByLabel('Part').selectOption(part);
        seen.push(await picture());
    }
    await page.getByLabel('Times A').uncheck();
    seen.push(await picture());
    assert.equal(new Set(seen.map(bytes => bytes.toString('base64'))).size, seen.length, 'two choices look alike');
});

test('The edited lighting is shown at once and baked as a request: turned, exposed, with a light', async () => {
    await open('first');
    const bake = page.getByRole('button', { name: 'Bake this lighting' });
    assert.ok(await bake.isDisabled(), 'there is an edit to bake before one was made');
    const before = await picture();
    await slider('Turn about the vertical').fill('60');
    const turned = await picture();
    assert.ok(!turned.equals(before), 'turning the sky changed nothing');
    await slider('Exposure').press('ArrowRight');
    await page.getByRole('button', { name: 'Add a light' }).click();
    await slider('Elevation').fill('90');
    await slider('Irradiance').fill('4');
    assert.ok(!(await picture()).equals(turned), 'the light changed nothing');
    await bake.click();
    await page.getByRole('link', { name: 'open the new bake' }).waitFor();
    assert.equal(await page.getByRole('link', { name: 'open the new bake' }).getAttribute('href'), '#/view/new');
    assert.equal(await page.getByRole('link', { name: 'compare' }).getAttribute('href'), '#/view/first/new');
    assert.deepEqual(posted, [
        {
            hair: 'sha256:0',
            environment: 'name:stage/dawn@2', // the reference of the old bake
            outputs: ['raw'],
            environment_settings: { rotation_deg: [0, 90, 0], exposure_stops: 1.1, tint: [1, 1, 1] },
            irradiance: { lights: [{ direction: [0, 1, 0], irradiance: [4, 4, 4] }] },
        },
    ]);
});

test('The lighting of the bake that is shown is baked, not that of the first one', async () => {
    await open('first/second');
    await page.getByText('Exponent 64, as baked').waitFor();
    await page.getByLabel('Split').selectOption('One picture');
    await page.getByRole('combobox', { name: 'Bake', exact: true }).selectOption({ index: 1 });
    await page.getByText('Exponent 20, as baked').waitFor();
    await slider('Turn about the vertical').fill('60');
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    assert.equal(await page.getByRole('link', { name: 'compare' }).getAttribute('href'), '#/view/second/new');
    assert.deepEqual(posted[0].environment_settings.rotation_deg, [0, 70, 0]);
});

test('With another bake beside it camera and edit stay, and shared files are not fetched again', async () => {
    await open('first');
    const fetched = [];
    page.on('request', request => fetched.push(new URL(request.url()).pathname));
    await page.focus('.viewer canvas');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('+');
    await slider('Albedo').fill('0.9');
    await slider('Turn about the vertical').fill('60');
    const before = await picture();
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    await page.getByRole('link', { name: 'compare' }).click();
    await page.getByText(/^new.*, as baked$/).waitFor(); // the edit is in its maps
    assert.match(await page.innerText('.viewer-captions'), /first.*, edited/);
    await picture();
    await page.goBack();
    await page.waitForFunction(() => document.querySelectorAll('.viewer-captions span').length === 1);
    assert.ok((await picture()).equals(before), 'camera, look or edit is another');
    assert.deepEqual(
        fetched.filter(path => path.includes('/files/')),
        ['maps.json', 'maps.f16'].map(name => `/v1/bakes/new/files/${name}`),
    );
    await page.getByRole('link', { name: 'open the new bake' }).click();
    await page.locator('.viewer-captions').getByText('new').waitFor();
    assert.ok(await page.getByRole('button', { name: 'Bake this lighting' }).isDisabled(), 'it is edited twice');
});

test('The edit is not applied to the bake that holds it, also where the edit has changed since', async () => {
    await open('first');
    await slider('Turn about the vertical').fill('60');
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    await page.getByRole('link', { name: 'compare' }).waitFor();
    await slider('Exposure').press('ArrowRight');
    await page.getByRole('link', { name: 'compare' }).click();
    await page.getByText(/^new.*, as baked$/).waitFor();
    assert.match(await page.innerText('.viewer-captions'), /first.*, edited/);
    assert.equal(await slider('Exposure').inputValue(), '0.1');
    await page.getByRole('link', { name: 'open the new bake' }).click();
    await page.waitForFunction(() => document.querySelectorAll('.viewer-captions span').length === 1);
    assert.doesNotMatch(await page.innerText('.viewer-captions'), /edited/);
    assert.equal(await slider('Turn about the vertical').inputValue(), '0');
    assert.equal(await slider('Exposure').inputValue(), '0');
});

test('An edit that begins in a bake ordered here is an edit of that bake', async () => {
    await open('first');
    await slider('Turn about the vertical').fill('60');
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    await page.getByRole('link', { name: 'open the new bake' }).click();
    await page.locator('.viewer-captions').getByText('new').waitFor();
    ordered = 'second';
    await slider('Turn about the vertical').fill('20');
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    await page.getByRole('link', { name: 'compare' }).click();
    await page.getByText(/^second.*, as baked$/).waitFor();
    assert.match(await page.innerText('.viewer-captions'), /new.*, edited/);
    assert.deepEqual(posted[1].environment_settings.rotation_deg, [0, 50, 0]); // 30 of the simulated bake, and 20
    await page.goBack();
    await page.waitForFunction(() => document.querySelectorAll('.viewer-captions span').length === 1);
    assert.match(await page.innerText('.viewer-captions'), /new.*, edited/);
    assert.equal(await slider('Turn about the vertical').inputValue(), '20');
});

test('A refusal of the service is shown as text', async () => {
    await open('first');
    refusal = hostile;
    await slider('Turn about the vertical').fill('60');
    await page.getByRole('button', { name: 'Bake this lighting' }).click();
    await page.getByText(`It was not baked: ${hostile}`).waitFor();
});

test('A bake is watched through lost answers, until the service refuses', async () => {
    await open('first');
    polls = [json({ detail: 'Not now.' }, 503)];
    await slider('Turn about the vertical').fill('60');
    const bake = page.getByRole('button', { name: 'Bake this lighting' });
    await bake.click();
    await page.getByText('The new bake is queued. Not now. The request is repeated.').waitFor();
    polls = [json({ detail: 'Too many.' }, 429)];
    await page.getByText('The new bake is queued. Too many. The request is repeated.').waitFor();
    assert.ok(await bake.isDisabled());
    polls = [going];
    await page.getByText('The new bake is running.', { exact: true }).waitFor();
    polls = [done];
    await page.getByRole('link', { name: 'open the new bake' }).waitFor();
    assert.ok(await bake.isEnabled());
    polls = [json({ detail: 'no such bake' }, 404)];
    await bake.click();
    await page.getByText('The new bake can no longer be watched: no such bake').waitFor();
    assert.ok(await bake.isEnabled());
});

test('At most eight lights are added, and a light can be removed', async () => {
    await open('first');
    const add = page.getByRole('button', { name: 'Add a light' });
    for (let i = 0; i < 8; i++) await add.click();
    assert.ok(await add.isDisabled());
    await page.getByRole('button', { name: 'Remove light 3' }).click();
    assert.equal(await page.getByRole('button', { name: /Remove light/ }).count(), 7);
    assert.ok(await add.isEnabled());
});

test('The brightness that is chosen for a dim sky is on the slider', async () => {
    await open('dim');
    const brightness = slider('Brightness');
    const [value, text] = await brightness.evaluate(input => [input.valueAsNumber, input.ariaValueText]);
    assert.ok(value > 17 && value < 23, `${value} stops for light of 2^-20`);
    assert.ok(Math.abs(parseFloat(text) - value) <= 0.05, `${text}, and the slider is at ${value}`); // half a step
});

test("A screenshot is a PNG of the picture's size", async () => {
    await open('first');
    const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('button', { name: 'Screenshot' }).click(),
    ]);
    assert.equal(download.suggestedFilename(), 'hairbake_first.png');
    const bytes = readFileSync(await download.path());
    assert.equal(bytes.toString('latin1', 1, 4), 'PNG');
    const size = await page.$eval('.viewer canvas', canvas => [canvas.width, canvas.height]);
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], size);
});

test('A bake without the output raw gives a message and a button that bakes it with raw', async () => {
    await open('unread');
    assert.match(await page.innerText('.viewer-problem'), /did not write the output "raw"/);
    await page.getByRole('button', { name: 'Bake it with "raw"' }).click();
    await page.getByRole('link', { name: 'open the new bake' }).waitFor();
    assert.deepEqual(posted[0].outputs, ['npy', 'raw']);
    assert.equal(posted[0].hair, 'name:heads/curly@1');
});

test('A bake without hair and one with inconsistent files give a message', async () => {
    await open('bald');
    assert.match(await page.innerText('.viewer-problem'), /This bake has no hair\. The viewer needs both/);
    await page.close();
    await open('broken');
    assert.match(
        await page.innerText('.viewer-problem'),
        /strands\.bin does not hold positions as strands\.json states/,
    );
});

test('An expired session is reported to the page, which asks for a token', async () => {
    expired = true;
    await open('first');
    assert.match(await page.innerText('.viewer-problem'), /strands.json .* could not be fetched: A token is needed/);
    assert.ok(await page.evaluate(() => window.locked));
});

test('A browser without WebGL 2 gets a message', async () => {
    page = await open_page(browser);
    await page.addInitScript(() => {
        HTMLCanvasElement.prototype.getContext = () => null;
    });
    await page.goto(`${server.origin}/#/first`);
    await page.getByText('This browser has no WebGL 2').waitFor();
    page.problems = page.problems.filter(problem => !/THREE.WebGLRenderer/.test(problem));
});

test('Unmounting gives the graphics context back', async () => {
    await open('first');
    const lost = await page.evaluate(() => {
        const gl = document.querySelector('.viewer canvas').getContext('webgl2');
        window.unmount();
        return new Promise(done => setTimeout(() => done(gl.isContextLost()), 200));
    });
    assert.ok(lost);
});

test('On a tablet and at 200 % zoom nothing is wider than the page', async () => {
    for (const viewport of [
        { width: 768, height: 1024 },
        { width: 640, height: 360 },
    ]) {
        await open('first/second', { viewport });
        await page.screenshot({ path: join(pictures, `viewer_${viewport.width}.png`), fullPage: true });
        const wide = await page.evaluate(
            () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
        );
        assert.equal(wide, 0);
        if (viewport.width === 768) await page.close();
    }
});
