// Rejected requests that are worth sending again, and the wait before that.

const longest_wait_ms = 120_000; // a proxy may ask for any time

/** The sender is too slow for a proxy (408), or the service or a proxy is busy with this client (429). */
export const is_turned_away = status => status === 408 || status === 429;

/** The wait that a Retry-After header (seconds or a date) asks for; 0 where the header is missing or unreadable. */
export function wait_ms_of(header) {
    if (!header) return 0;
    const ms = /^\d+$/.test(header) ? 1000 * Number(header) : Date.parse(header) - Date.now();
    return ms > 0 ? Math.min(ms, longest_wait_ms) : 0;
}

/** Resolves after the time, or as soon as `signal` is aborted. */
export function pause(milliseconds, signal) {
    return new Promise(resolve => {
        if (signal?.aborted) return resolve();
        const timer = setTimeout(resolve, milliseconds);
        signal?.addEventListener('abort', () => (clearTimeout(timer), resolve()), { once: true });
    });
}
