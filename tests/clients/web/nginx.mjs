// nginx in front of a daemon, with no more than what a page's speed depends on: kept connections and compression.
import { spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { patience_ms } from './daemon.mjs';

export function free_port() {
    return new Promise(found => {
        const server = createServer().listen(0, '127.0.0.1', () => {
            const { port } = server.address();
            server.close(() => found(port));
        });
    });
}

const config = (port, address) => `
daemon off;
pid nginx.pid;
error_log stderr warn;
events {}
http {
    access_log off;
    client_body_temp_path body;
    proxy_temp_path proxy;
    fastcgi_temp_path unused;
    uwsgi_temp_path unused;
    scgi_temp_path unused;
    gzip on;
    gzip_proxied any;
    gzip_types application/json text/css text/javascript image/svg+xml;
    server {
        listen 127.0.0.1:${port};
        location / {
            proxy_http_version 1.1;
            proxy_set_header Connection close;
            proxy_set_header Host $http_host;
            proxy_request_buffering off;
            proxy_pass ${address};
        }
    }
}
`;

/** { address, stop() } */
export async function start_nginx(daemon_address) {
    const folder = mkdtempSync(join(tmpdir(), 'hairbake-nginx-'));
    mkdirSync(join(folder, 'body'));
    const port = await free_port();
    writeFileSync(join(folder, 'nginx.conf'), config(port, daemon_address));
    const nginx = spawn('nginx', ['-p', folder, '-c', join(folder, 'nginx.conf')], {
        stdio: ['ignore', 'ignore', 'pipe'],
        env: { ...process.env, PATH: `${process.env.PATH}:/usr/sbin` },
    });
    let log = '';
    nginx.stderr.on('data', text => (log += text));
    const address = `http://127.0.0.1:${port}`;
    for (const end = Date.now() + patience_ms; ; await new Promise(done => setTimeout(done, 50))) {
        if (nginx.exitCode !== null || Date.now() > end) throw new Error(`nginx did not start: ${log}`);
        if (
            await fetch(`${address}/healthz`).then(
                reply => reply.ok,
                () => false,
            )
        )
            break;
    }
    const stop = async () => {
        const ended = new Promise(done => nginx.once('exit', done));
        nginx.kill('SIGTERM');
        await ended;
        rmSync(folder, { recursive: true, force: true });
    };
    return { address, stop };
}
