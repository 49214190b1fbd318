// What passes when one waits: a request that was turned away for now is sent again, after the time that the answer asks
// for.

const longest_wait_ms = 120_000; // whatever a proxy says

/** A proxy's haste (408, 429), or a service that has as much of this token's as it allows (429). */
export const is_turned_away = status => status === 408 || status === 429;

/** Of the header Retry-After, which is a number of seconds or a date; 0 without one that can be read. */
export function wait_ms_of(header) {
    if (!header) return 0;
    const ms = /^\d+$/.test(header) ? 1000 * Number(header) : Date.parse(header) - Date.now();
    return ms > 0 ? Math.min(ms, longest_wait_ms) : 0;
}

/** Ends early when `signal` is aborted. */
export function pause(milliseconds, signal) {
    return new Promise(resolve => {
        if (signal?.aborted) return resolve();
        const timer = setTimeout(resolve, milliseconds);
        signal?.addEventListener('abort', () => (clearTimeout(timer), resolve()), { once: true });
    });
}
