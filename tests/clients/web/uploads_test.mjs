// Uploads of the page: interrupted, resumed, turned away, cancelled, in two tabs. The real daemon, in Chromium.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { hairbake, patience_ms } from './daemon.mjs';
import { PageSession, sha256, slow, throttle } from './page_session.mjs';

let session, daemon, sample;

before(async () => {
    session = await PageSession.start();
    ({ daemon, sample } = session);
});
after(() => session?.stop());

/** The offsets at which pieces of uploads begin, one a PATCH request. */
function watch_patches(page) {
    const offsets = [];
    page.on('request', request => {
        if (request.method() === 'PATCH') offsets.push(Number(request.headers()['upload-offset']));
    });
    return offsets;
}

/** A groom of some megabytes, with another digest for every seed. Sending it at `slow` takes a while. */
function large_groom(seed) {
    const folder = join(sample, String(seed));
    hairbake('sample', folder, '--vertices', '600000', '--map-width', '16', '--seed', String(seed));
    return join(folder, 'groom.hair');
}

async function send_slowly(page, file) {
    await page.goto(`${daemon.address}/#/models`);
    await page.getByRole('heading', { name: 'Stored' }).waitFor({ state: 'attached' });
    await throttle(page, slow);
    await page.locator('.drop-zone input[type=file]').setInputFiles(file);
    await page.locator('.job[data-phase=sending] progress[value]').waitFor();
    await page.waitForFunction(() => document.querySelector('.job[data-phase=sending] progress')?.value > 0.15);
}

async function assert_stored(file) {
    const digest = sha256(readFileSync(file));
    const reply = await fetch(`${daemon.address}/v1/models/${digest}`);
    assert.equal(reply.status, 200, `${file} is not stored`);
}

const turned_away = (detail, wait_s) => ({
    status: 429,
    headers: { 'Retry-After': String(wait_s) },
    contentType: 'application/problem+json',
    json: { detail },
});

test('an upload resumes where a reload of the page interrupted it', async () => {
    const file = large_groom(11);
    await session.with_page(async page => {
        const offsets = watch_patches(page);
        await send_slowly(page, file);
        await page.reload();
        await throttle(page, -1);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.ok(offsets.at(-1) > 0, `the last PATCH began at ${offsets.at(-1)}`);
        await assert_stored(file);
    });
});

test('an upload resumes after the connection was cut', async () => {
    const file = large_groom(12);
    await session.with_page(async page => {
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

test('an upload that is turned away waits for the time of Retry-After, and resumes where it was', async () => {
    const file = large_groom(16);
    const reason = 'more requests or uploads at once than allowed';
    await session.with_page(async page => {
        const offsets = watch_patches(page);
        const once = new Map(); // each kind of request is turned away once; of PATCH, the second piece
        await page.route(/\/v1\/(blobs|uploads|models)/, route => {
            const request = route.request();
            const kind = `${request.method()} ${new URL(request.url()).pathname.split('/')[2]}`;
            const is_first_piece = Number(request.headers()['upload-offset']) === 0;
            if (request.method() === 'GET' || is_first_piece || once.has(kind)) return route.continue();
            once.set(kind, Date.now());
            return route.fulfill(turned_away(reason, kind === 'PATCH uploads' ? 2 : 0));
        });
        const resumed = page.waitForRequest(request => request.method() === 'HEAD' && /uploads/.test(request.url()));
        await page.goto(`${daemon.address}/#/models`);
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await page.getByText(`The request is repeated: ${reason}`).waitFor();
        await resumed;
        const waited_ms = Date.now() - once.get('PATCH uploads');
        assert.ok(waited_ms >= 2000, `the request was repeated after ${waited_ms} ms`);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.deepEqual(
            [...once.keys()],
            ['HEAD blobs', 'POST uploads', 'PATCH uploads', 'HEAD uploads', 'POST models'],
        );
        assert.equal(offsets.filter(offset => offset === 0).length, 1, `PATCH requests began at ${offsets}`);
        await assert_stored(file);
    });
});

test('a file that is turned away again and again gives a message and is kept', async () => {
    const reason = 'there are 256 unfinished uploads of this token; allowed are 256: finish some or delete them';
    const bytes = session.groom_with('turned away');
    await session.with_page(async page => {
        let tries = 0;
        await page.route('**/v1/uploads', route => {
            ++tries;
            return route.fulfill(turned_away(reason, 60));
        });
        await page.addInitScript(() => {
            const wait = setTimeout;
            globalThis.setTimeout = (act, ms) => wait(act, Math.min(ms, 20)); // minutes in all
        });
        await page.goto(`${daemon.address}/#/models`);
        const file = { name: 'away.hair', mimeType: '', buffer: bytes };
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await page.locator('.job[data-phase=failed] [role=alert]', { hasText: reason }).waitFor();
        assert.equal(tries, 11); // the first try, and one after each of ten pauses
        await page.unrouteAll({ behavior: 'wait' });
        await page.reload(); // which resumes what is kept
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.equal((await fetch(`${daemon.address}/v1/models/${sha256(bytes)}`)).status, 200);
    });
});

test('a file that the service has is not sent again', async () => {
    await session.with_page(async page => {
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

test('a file that is not an environment is refused with a message', async () => {
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/environments`);
        await page
            .locator('.drop-zone input[type=file]')
            .setInputFiles({ name: 'notes.hdr', mimeType: '', buffer: Buffer.from('shopping list') });
        const job = page.locator('.job[data-phase=failed]');
        await job.waitFor();
        assert.match(await job.locator('[role=alert]').innerText(), /sha256:[0-9a-f]{64}/); // not the path of the file
    });
});

test('Cancel ends an upload here and on the service, and the next file is sent', async () => {
    const [file, next] = [large_groom(13), large_groom(14)];
    await session.with_page(async page => {
        const uploads = [];
        page.on('request', request => request.method() === 'PATCH' && uploads.push(request.url()));
        await send_slowly(page, [file, next]);
        await throttle(page, 1e5); // so slow that the file is not complete before the click, also on a busy machine
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
    await session.with_page(async page => {
        const sent = [];
        page.on('request', request => request.url().includes('/v1/uploads') && sent.push(request.method()));
        let asked, cancelled;
        const question = new Promise(resolve => (asked = resolve));
        const cancel = new Promise(resolve => (cancelled = resolve));
        await page.route('**/v1/blobs/*', async route => {
            asked();
            await cancel;
            await route.continue().catch(() => {}); // the page has aborted the request
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
        await page.getByText('the service had it already: nothing was sent').waitFor(); // the queue continues
        assert.deepEqual(sent, []);
    });
});

test('a second tab leaves an upload to the first one until that is closed', async () => {
    const file = large_groom(15);
    await session.with_page(async (page, context) => {
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
        await page.goto('about:blank'); // closing the page would first release the piece that is held back
        await other.locator('.job[data-phase=stored]').waitFor({ timeout: patience_ms });
        assert.ok(offsets.at(0) > 0, `the first PATCH began at ${offsets.at(0)}`);
        await assert_stored(file);
    });
});

test('a file is sent also where the browser has no room to store its name', async () => {
    const bytes = session.groom_with('one more groom');
    await session.with_page(async page => {
        await page.goto(`${daemon.address}/#/models`);
        await page.evaluate(() => {
            for (let size = 1 << 22; size >= 1; size /= 2)
                try {
                    for (let i = 0; ; ++i) localStorage.setItem(`filler ${size} ${i}`, 'x'.repeat(size));
                } catch {
                    // no room for a larger item
                }
        });
        const file = { name: 'more.hair', mimeType: '', buffer: bytes };
        await page.locator('.drop-zone input[type=file]').setInputFiles(file);
        await page.locator('.job[data-phase=stored]').waitFor();
        assert.equal((await fetch(`${daemon.address}/v1/models/${sha256(bytes)}`)).status, 200);
    });
});
