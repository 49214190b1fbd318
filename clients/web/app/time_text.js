// Durations and points in time as text.

export function duration_text(seconds) {
    if (seconds < 1) return `${Math.round(seconds * 1000)} ms`;
    if (seconds < 10) return `${seconds.toFixed(1)} s`;
    if (seconds < 90) return `${Math.round(seconds)} s`;
    if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
    return `${(seconds / 3600).toFixed(1)} h`;
}

export function time_text(iso) {
    const time = new Date(iso);
    return Number.isNaN(time.getTime())
        ? iso
        : time.toLocaleString('en-GB', { dateStyle: 'medium', timeStyle: 'short' });
}
