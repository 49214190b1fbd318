// Linear RGB in [0, 1] and the #rrggbb of colour inputs (sRGB).

export function to_hex(linear) {
    const code = x => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
    return (
        '#' +
        linear
            .map(x =>
                code(Math.min(Math.max(x, 0), 1))
                    .toString(16)
                    .padStart(2, '0'),
            )
            .join('')
    );
}

export function from_hex(hex) {
    const channel = i => parseInt(hex.slice(1 + 2 * i, 3 + 2 * i), 16) / 255;
    return [0, 1, 2].map(channel).map(x => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
}
