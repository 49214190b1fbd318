// Half floats (IEEE binary16): conversion from and to their 16 bits.

export function from_half(bits) {
    const exponent = (bits >> 10) & 31,
        mantissa = bits & 1023;
    let magnitude;
    if (exponent === 31) magnitude = mantissa ? NaN : Infinity;
    else magnitude = exponent ? (1 + mantissa / 1024) * 2 ** (exponent - 15) : mantissa * 2 ** -24;
    return bits & 0x8000 ? -magnitude : magnitude;
}

/** The nearest half float; a tie goes to the even one. */
export function to_half(value) {
    const sign = value < 0 ? 0x8000 : 0,
        magnitude = Math.abs(value);
    if (Number.isNaN(value)) return 0x7e00;
    if (magnitude >= 65520) return sign | 0x7c00;
    const exponent = Math.max(Math.floor(Math.log2(magnitude)), -14);
    return sign | (((exponent + 14) << 10) + round_to_even(magnitude / 2 ** (exponent - 10)));
}

/** Every `stride`-th of the half floats, from the one at `first`. */
export function half_values(halves, first, stride) {
    const values = new Float32Array(Math.ceil((halves.length - first) / stride));
    for (let i = 0, at = first; i < values.length; ++i, at += stride) values[i] = from_half(halves[at]);
    return values;
}

function round_to_even(value) {
    const whole = Math.floor(value),
        rest = value - whole;
    return whole + (rest > 0.5 || (rest === 0.5 && whole % 2 === 1) ? 1 : 0);
}
