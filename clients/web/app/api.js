// Asks the daemon. Every failure becomes a Problem with words for people.
import { pause, wait_ms_of } from './patience.js';

export class Problem extends Error {
    /**
     * status 0: the service could not be reached; field: the request's field at fault or ''; wait_ms: when the service
     * wants to be asked again, 0 where it does not say.
     */
    constructor(status, words, { field = '', wait_ms = 0 } = {}) {
        super(words);
        this.status = status;
        this.field = field;
        this.wait_ms = wait_ms;
    }
}

async function problem_of(reply) {
    let body = {};
    try {
        body = await reply.json();
    } catch {
        // A proxy's own error page: the status says all there is.
    }
    return new Problem(reply.status, body.detail || `The service answered ${reply.status}.`, {
        field: body.field || '',
        wait_ms: wait_ms_of(reply.headers.get('Retry-After')),
    });
}

// What asking again does not change; all else (a proxy's 429, a daemon that starts anew) passes.
const final_statuses = new Set([400, 401, 403, 404, 405, 410, 422]);

/** `on_locked` is called when the daemon demands a token. */
export function make_api(on_locked) {
    async function ask(path, options = {}) {
        let reply;
        try {
            reply = await fetch(path, { credentials: 'same-origin', ...options });
        } catch (error) {
            if (options.signal?.aborted) throw error;
            throw new Problem(0, 'The service does not answer; it may have stopped, or the network is gone.');
        }
        if (reply.ok || reply.status === 304) return reply;
        const problem = await problem_of(reply);
        if (problem.status === 401) on_locked();
        throw problem;
    }
    const with_body =
        method =>
        async (path, object, query = '') => {
            const headers = { 'Content-Type': 'application/json' };
            const reply = await ask(path + query, { method, headers, body: JSON.stringify(object) });
            return reply.status === 204 ? null : reply.json();
        };

    const api = {
        ask,
        post: with_body('POST'),
        put: with_body('PUT'),
        async json(path, options) {
            return (await ask(path, options)).json();
        },
        async remove(path) {
            const reply = await ask(path, { method: 'DELETE' });
            return reply.status === 204 ? null : reply.json();
        },
        file_url(bake, name) {
            return `/v1/bakes/${encodeURIComponent(bake)}/files/${encodeURIComponent(name)}`;
        },

        /**
         * Asks again and again, by ETag, until `signal` is aborted, on_value returns true, or asking again would change
         * nothing. on_problem gets null when what was wrong has passed.
         */
        async watch(path, every_ms, on_value, on_problem, signal) {
            let tag = null;
            let lost = false;
            while (!signal.aborted) {
                try {
                    const headers = tag ? { 'If-None-Match': tag } : {};
                    const reply = await ask(path, { headers, cache: 'no-store', signal });
                    if (lost && !signal.aborted) on_problem(null);
                    lost = false;
                    if (reply.status !== 304) {
                        tag = reply.headers.get('ETag');
                        const value = await reply.json();
                        if (!signal.aborted && on_value(value)) return;
                    }
                } catch (problem) {
                    if (signal.aborted) return;
                    on_problem(problem);
                    lost = true;
                    if (final_statuses.has(problem.status)) return;
                }
                await pause(document.hidden ? 5 * every_ms : every_ms, signal);
            }
        },

        /** The request's schema and the presets, from the OpenAPI document. */
        contract() {
            api.promise ??= api.json('/openapi.json').then(({ components }) => ({
                schema: components.schemas.BakeRequest,
                presets: Object.entries(components.examples ?? {}).map(([name, { summary, value }]) => ({
                    name,
                    description: summary,
                    request: value,
                })),
            }));
            api.promise.catch(() => (api.promise = null)); // the next one asks again
            return api.promise;
        },
    };
    return api;
}
