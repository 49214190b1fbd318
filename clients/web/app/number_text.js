// Numbers, counts and sizes in bytes as text.

export function bytes_text(bytes) {
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

/** At most `digits` significant digits, without an exponent where plain digits are readable. */
export function number_text(value, digits = 4) {
    if (!Number.isFinite(value)) return String(value);
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(digits - 1);
    return String(Number(value.toPrecision(digits)));
}

export const count_text = (count, one, many = `${one}s`) =>
    `${count.toLocaleString('en')} ${count === 1 ? one : many}`;
