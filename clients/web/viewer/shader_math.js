// Mathematics that the shader and the page share.
//
// The built-in sin, cos and acos of software WebGL have errors up to 4e-4. With 33 maps between 0 and pi that is 4e-3
// of the step from map to map. Polynomials and square roots have errors of 3e-7.

/**
 * Angle between unit vectors from q = |a - b|^2 in [0, 2]: sqrt(q) times this polynomial in q, lowest power first, is
 * 2 asin(sqrt(q) / 2) to 9e-8 (3.5e-7 in single precision). Fitted by weighted least squares to an even error. The dot
 * product is not exact enough: near 0 and pi its rounding error of 6e-8 changes the angle by 3e-4.
 */
export const angle_polynomial = [
    1.0000009, 0.0416509322, 0.0047664137, 0.000525499517, 0.000305898683, -8.10274692e-5, 2.88555483e-5,
];

/** sin(u), u in [0, pi/2]: u times this polynomial in u^2, to 4e-9. */
export const sine_polynomial = [0.999999977, -0.166666476, 0.00833289983, -0.000198008982, 2.59048942e-6];

/** GLSL of a polynomial in `x` by Horner's rule. */
export function glsl_polynomial(coefficients, x) {
    return coefficients.reduceRight(
        (inner, c) => (inner ? `(${glsl_number(c)} + ${x} * ${inner})` : glsl_number(c)),
        '',
    );
}

export function glsl_number(value) {
    return Number.isInteger(value) ? value.toFixed(1) : String(value);
}

/**
 * The sixteen real harmonics of four bands in the unit direction [x, y, z], order l * l + l + m, z polar, no
 * Condon-Shortley phase (core/base/spherical_harmonics.h).
 */
export function harmonics([x, y, z]) {
    const root = Math.sqrt,
        pi = Math.PI;
    const c1 = root(3 / (4 * pi)),
        c2 = root(15 / (4 * pi)),
        c3 = root(35 / (32 * pi)),
        d3 = root(21 / (32 * pi));
    return [
        root(1 / (4 * pi)),
        c1 * y,
        c1 * z,
        c1 * x,
        c2 * x * y,
        c2 * y * z,
        root(5 / (16 * pi)) * (3 * z * z - 1),
        c2 * x * z,
        (c2 / 2) * (x * x - y * y),
        c3 * y * (3 * x * x - y * y),
        root(105 / (4 * pi)) * x * y * z,
        d3 * y * (5 * z * z - 1),
        root(7 / (16 * pi)) * z * (5 * z * z - 3),
        d3 * x * (5 * z * z - 1),
        root(105 / (16 * pi)) * z * (x * x - y * y),
        c3 * x * (x * x - 3 * y * y),
    ];
}
