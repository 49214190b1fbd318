// The real daemon with a sample groom, a sky and a finished bake, and pages of Chromium that collect their faults.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { launch, open_page, require_tool } from './browser.mjs';
import { Daemon, hairbake, patience_ms } from './daemon.mjs';

const axe = readFileSync(require_tool.resolve('axe-core/axe.min.js'), 'utf8');

export const sha256 = data => createHash('sha256').update(data).digest('hex');

/**
 * { daemon, browser, sample, groom, sky, bake }: sample is the folder of sample files; groom and sky are digests of
 * stored inputs; bake is the id of a finished bake of both.
 */
export class PageSession {
    static async start() {
        const session = new PageSession();
        const sample = (session.sample = mkdtempSync(join(tmpdir(), 'hairbake-sample-')));
        hairbake('sample', sample, '--vertices', '30000', '--map-width', '128');
        session.daemon = await Daemon.start();
        session.browser = await launch();
        session.groom = await session.daemon.add('model', join(sample, 'groom.hair'));
        session.sky = await session.daemon.add('environment', join(sample, 'sky.hdr'));
        const request = {
            hair: `sha256:${session.groom}`,
            environment: `sha256:${session.sky}`,
            outputs: ['npy', 'raw'],
            transmittance: { voxels: 32, directions: 16, reference_vertices: 16 },
            irradiance: { face_size: 4, specular_maps: 5 },
        };
        session.bake = (await session.daemon.post('/v1/bakes', request)).id;
        await session.daemon.finished(session.bake);
        return session;
    }

    async stop() {
        await this.browser.close();
        await this.daemon.stop();
        rmSync(this.sample, { recursive: true, force: true });
    }

    /** Calls act(page, context) with a new page; the page must have no faults at the end. options: of the context. */
    async with_page(act, { address = this.daemon.address, ...options } = {}) {
        const { context, page, faults } = await open_page(this.browser, address, options);
        page.setDefaultTimeout(patience_ms);
        try {
            await act(page, context);
            assert.deepEqual(faults, []);
        } finally {
            await context.close();
        }
    }

    /** Opens the form of a new bake; query: of its address. */
    async open_form(page, query = '') {
        await page.goto(`${this.daemon.address}/#/bake${query}`);
        await page.getByRole('button', { name: 'Bake', exact: true }).waitFor();
    }

    /** Points a name of the daemon at a file. */
    put_name(kind, path, digest) {
        return this.daemon.json(`/v1/names/${kind}/${path}`, {
            method: 'PUT',
            headers: { 'Content-Type': 'application/json' },
            body: JSON.stringify({ sha256: digest }),
        });
    }

    /** The sample's groom with another text in the 88 bytes of "info" of a HAIR header, so with another digest. */
    groom_with(text) {
        const bytes = Buffer.from(readFileSync(join(this.sample, 'groom.hair')));
        bytes.write(`${text}\0`, 40);
        return bytes;
    }
}

/** Limits the upload to so many bytes a second; 0 cuts the connection, -1 removes the limit. */
export async function throttle(page, bytes_per_second) {
    page.cdp ??= await page.context().newCDPSession(page);
    await page.cdp.send('Network.emulateNetworkConditions', {
        offline: bytes_per_second === 0,
        latency: 0,
        downloadThroughput: -1,
        uploadThroughput: bytes_per_second,
    });
}

export const slow = 3e6; // bytes a second at which a file of some megabytes takes a while

/** The request that the form shows as JSON. */
export const request_of_form = async page => JSON.parse(await page.locator('form pre').textContent());

/** Fails with everything that axe finds wrong in the page. name: of the page, for the message. */
export async function check_with_axe(page, name) {
    await page.evaluate(axe); // through the debugger, which ignores the page's policy
    const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
    const findings = violations.flatMap(({ id, help, nodes }) =>
        nodes.map(({ html }) => `${name}: ${id}: ${help}: ${html.slice(0, 160)}`),
    );
    assert.deepEqual(findings, []);
}
