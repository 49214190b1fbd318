// nginx with the committed configuration (docker/) in front of a daemon that demands tokens.
import { spawn } from 'node:child_process';
import {
    chmodSync,
    closeSync,
    copyFileSync,
    mkdtempSync,
    openSync,
    readFileSync,
    rmSync,
    writeFileSync,
} from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { patience_ms } from './daemon.mjs';

const docker = fileURLToPath(new URL('../../../docker/', import.meta.url));
const nobody = 65534;

export function free_port() {
    return new Promise(found => {
        const server = createServer().listen(0, '127.0.0.1', () => {
            const { port } = server.address();
            server.close(() => found(port));
        });
    });
}

/** The site's file; only the addresses of nginx and of the daemon are replaced. */
function site(port, daemon_address) {
    return readFileSync(join(docker, 'nginx-site.conf'), 'utf8')
        .replace(/server unix:[^;]+;/, `server ${new URL(daemon_address).host};`)
        .replace('listen 8000 ', `listen 127.0.0.1:${port} `);
}

/** { address, stop() } */
export async function start_nginx(daemon_address) {
    const folder = mkdtempSync(join(tmpdir(), 'hairbake-nginx-'));
    const port = await free_port();
    for (const name of ['nginx.conf', 'nginx-locations.conf']) copyFileSync(join(docker, name), join(folder, name));
    writeFileSync(join(folder, 'site.conf'), site(port, daemon_address));
    chmodSync(folder, 0o770);
    const log = openSync(join(folder, 'log'), 'a'); // nginx opens /dev/stdout, which fails with node's pipes
    chmodSync(join(folder, 'log'), 0o660);
    const nginx = spawn('nginx', ['-p', folder, '-c', join(folder, 'nginx.conf')], {
        stdio: ['ignore', log, log],
        env: { ...process.env, PATH: `${process.env.PATH}:/usr/sbin` },
        ...(process.getuid() === 0 && { uid: nobody, gid: process.getgid() }), // never as root, like a deployment
    });
    const address = `http://127.0.0.1:${port}`;
    for (const end = Date.now() + patience_ms; ; await new Promise(done => setTimeout(done, 50))) {
        if (nginx.exitCode !== null || Date.now() > end) throw new Error(readFileSync(join(folder, 'log'), 'utf8'));
        const alive = await fetch(`${address}/healthz`).then(
            reply => reply.ok,
            () => false,
        );
        if (alive) break;
    }
    const stop = async () => {
        const ended = new Promise(done => nginx.once('exit', done));
        nginx.kill('SIGTERM');
        await ended;
        closeSync(log);
        rmSync(folder, { recursive: true, force: true });
    };
    return { address, stop };
}
