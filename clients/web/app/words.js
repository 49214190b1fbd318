// Numbers, times and digests as people read them.

export const most_shown = 1000; // items of a list: more take long to draw, and nobody reads them

export function bytes_words(bytes) {
    if (bytes < 1000) return `${bytes} bytes`;
    const units = ['kB', 'MB', 'GB', 'TB'];
    let value = bytes;
    let unit = -1;
    do {
        value /= 1000;
        ++unit;
    } while (value >= 999.5 && unit < units.length - 1);
    return `${value < 9.95 ? value.toFixed(1) : value.toFixed(0)} ${units[unit]}`;
}

export function seconds_words(seconds) {
    if (seconds < 1) return `${Math.round(seconds * 1000)} ms`;
    if (seconds < 10) return `${seconds.toFixed(1)} s`;
    if (seconds < 90) return `${Math.round(seconds)} s`;
    if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
    return `${(seconds / 3600).toFixed(1)} h`;
}

/** At most `digits` significant digits, without an exponent where people do not need one. */
export function number_words(value, digits = 4) {
    if (!Number.isFinite(value)) return String(value);
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(digits - 1);
    return String(Number(value.toPrecision(digits)));
}

export const count_words = (count, one, many = `${one}s`) =>
    `${count.toLocaleString('en')} ${count === 1 ? one : many}`;

export const short_digest = digest => digest.slice(0, 10);

export function time_words(iso) {
    const time = new Date(iso);
    return Number.isNaN(time.getTime())
        ? iso
        : time.toLocaleString('en-GB', { dateStyle: 'medium', timeStyle: 'short' });
}

/** "face_size" -> "Face size". */
export function title_words(name) {
    const text = name
        .replaceAll('_', ' ')
        .replace(/\bsh\b/, 'SH')
        .replace(/\bdeg$/, '')
        .trim();
    return text[0].toUpperCase() + text.slice(1);
}

/** A file's name as a name in the service: letters, digits, '.', '_', '-' (names.cpp). */
export function name_from_file(file_name) {
    const stem = file_name.replace(/\.[^.]{1,5}$/, '');
    return stem
        .replace(/[^A-Za-z0-9._-]+/g, '-')
        .replace(/^[-.]+|[-.]+$/g, '')
        .slice(0, 100);
}
