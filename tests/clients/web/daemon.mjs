// The real daemon with the real page, in its own folder, on a free port of 127.0.0.1.
import { spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

const source = resolve(dirname(fileURLToPath(import.meta.url)), '../../..');
const programs = process.env.HAIRBAKE_PROGRAMS ?? join(source, 'build/bin');

export const patience_ms = Number(process.env.HAIRBAKE_PATIENCE ?? 180) * 1000; // only ever reached by a failure

/** Puts the page's files into `folder`. */
export function stage_page(folder) {
    const run = spawnSync(process.execPath, [join(source, 'clients/web/stage.mjs'), folder], { encoding: 'utf8' });
    if (run.status !== 0) throw new Error(`the page could not be staged: ${run.stderr}`);
}

/** Runs `hairbake` with arguments; its output is in the error when it fails. */
export function hairbake(...words) {
    const run = spawnSync(join(programs, 'hairbake'), words, { encoding: 'utf8' });
    if (run.status !== 0) throw new Error(`hairbake ${words.join(' ')}: ${run.stderr}`);
}

function token_table(token) {
    const digest = createHash('sha256').update(token).digest('hex');
    return `[[token]]\nname = "artist"\nsha256 = "${digest}"\nscopes = ["read", "upload", "bake"]\n`;
}

export class Daemon {
    /** token: the daemon demands it, and the requests of this class send it. */
    static async start({ token = '' } = {}) {
        const daemon = new Daemon();
        daemon.headers = token ? { Authorization: `Bearer ${token}` } : {};
        daemon.folder = mkdtempSync(join(tmpdir(), 'hairbake-page-'));
        stage_page(join(daemon.folder, 'web'));
        const config = join(daemon.folder, 'hairbake.toml');
        writeFileSync(
            config,
            '[listen]\nport = 0\n[store]\nfolder = "store"\n[workers]\ncount = 1\nthreads = 1\n' +
                `[web]\nfolder = "web"\n${token && token_table(token)}`,
        );
        daemon.process = spawn(join(programs, 'hairbaked'), ['--config', config], {
            stdio: ['ignore', 'pipe', 'pipe'],
        });
        let log = '';
        daemon.process.stderr.on('data', text => (log += text));
        for await (const line of createInterface({ input: daemon.process.stdout })) {
            daemon.address = line.match(/listens on (http:\S+)/)?.[1];
            if (daemon.address) break;
        }
        if (!daemon.address) throw new Error(`the daemon did not start: ${log}`);
        return daemon;
    }

    async stop() {
        const ended = new Promise(done => this.process.once('exit', done));
        this.process.kill('SIGTERM');
        await ended;
        rmSync(this.folder, { recursive: true, force: true });
    }

    async json(path, options) {
        const reply = await fetch(this.address + path, {
            ...options,
            headers: { ...this.headers, ...options?.headers },
        });
        if (!reply.ok) throw new Error(`${path}: ${reply.status} ${await reply.text()}`);
        return reply.json();
    }
    post(path, object) {
        return this.json(path, {
            method: 'POST',
            headers: { 'Content-Type': 'application/json' },
            body: JSON.stringify(object),
        });
    }

    /** Sends a file and has it read; returns its digest. */
    async add(kind, file) {
        const reply = await fetch(`${this.address}/v1/${kind}s`, {
            method: 'POST',
            headers: { ...this.headers, 'Content-Type': 'application/octet-stream' },
            body: readFileSync(file),
        });
        if (!reply.ok) throw new Error(`${file}: ${reply.status} ${await reply.text()}`);
        return (await reply.json()).id;
    }

    /** The bake's view once it is done. */
    async finished(id) {
        for (const end = Date.now() + patience_ms; Date.now() < end; await new Promise(done => setTimeout(done, 100))) {
            const bake = await this.json(`/v1/bakes/${id}`);
            if (bake.state === 'done') return bake;
            if (bake.state === 'failed' || bake.state === 'cancelled') throw new Error(JSON.stringify(bake.error));
        }
        throw new Error(`the bake ${id} does not end`);
    }
}
