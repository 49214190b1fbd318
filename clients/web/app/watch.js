// A document of the service that is fetched again and again while it changes.
import { pause } from './retry.js';

// With these statuses the next answer would be the same. Others are temporary: a proxy's 429, a starting daemon's 503.
const final_statuses = new Set([400, 401, 403, 404, 405, 410, 422]);

const hidden_factor = 5; // a hidden page asks less often

/**
 * Fetches `path` every `every_ms`, by ETag. Ends when `signal` is aborted, when on_value(value) returns true, or with a
 * status after which the next answer would be the same.
 * ask(path, options): sends a request, as Api.ask;
 * on_problem(problem): called with each failure, and with null at the first success after one.
 */
export async function watch(ask, path, every_ms, on_value, on_problem, signal) {
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
        await pause(document.hidden ? hidden_factor * every_ms : every_ms, signal);
    }
}
