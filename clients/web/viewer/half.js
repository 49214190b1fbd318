// Half floats (IEEE binary16) as bits.

export function from_half(bits) {
    const exponent = (bits >> 10) & 31,
        mantissa = bits & 1023;
    let magnitude;
    if (exponent === 31) magnitude = mantissa ? NaN : Infinity;
    else magnitude = exponent ? (1 + mantissa / 1024) * 2 ** (exponent - 15) : mantissa * 2 ** -24;
    return bits & 0x8000 ? -magnitude : magnitude;
}

/** The nearest half, of two equally near the even one. */
export function to_half(value) {
    const sign = value < 0 ? 0x8000 : 0,
        magnitude = Math.abs(value);
    if (Number.isNaN(value)) return 0x7e00;
    if (magnitude >= 65520) return sign | 0x7c00;
    const exponent = Math.max(Math.floor(Math.log2(magnitude)), -14);
    return sign | (((exponent + 14) << 10) + round_to_even(magnitude / 2 ** (exponent - 10)));
}

function round_to_even(value) {
    const whole = Math.floor(value),
        rest = value - whole;
    return whole + (rest > 0.5 || (rest === 0.5 && whole % 2 === 1) ? 1 : 0);
}
