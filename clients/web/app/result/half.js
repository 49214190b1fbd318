// Half floats (IEEE 754 binary16), as maps.f16 and strands.bin hold them.

/** The number that 16 bits stand for. */
export function half_value(bits) {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    if (exponent === 0) return sign * fraction * 2 ** -24;
    return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}

/** Every `stride`-th of the half floats, from the one at `first`. */
export function half_values(halves, first, stride) {
    const values = new Float32Array(Math.ceil((halves.length - first) / stride));
    for (let i = 0, at = first; i < values.length; ++i, at += stride) values[i] = half_value(halves[at]);
    return values;
}
