// The pixels that the viewer should show, by the specification. Nothing here is taken from the viewer.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = a => Math.hypot(...a);
const plus = (a, b) => a.map((x, i) => x + b[i]);
const times = (a, s) => a.map(x => x * s);
export const normalized = a => times(a, 1 / length(a));
export const mix = (a, b, s) => a.map((x, i) => (1 - s) * x + s * b[i]);

/**
 * A camera that looks at `target` from `distance`; azimuth 0 from +Z, 90 from +X; `pixel` counts from the left bottom.
 */
export class Camera {
    constructor({ azimuth_deg, elevation_deg, distance, target, fov_deg }, width, height) {
        const a = (azimuth_deg * Math.PI) / 180,
            e = (elevation_deg * Math.PI) / 180;
        this.backward = [Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)];
        this.right = [Math.cos(a), 0, -Math.sin(a)];
        this.up = cross(this.backward, this.right);
        this.eye = plus(target, times(this.backward, distance));
        this.scale = (2 * Math.tan((fov_deg * Math.PI) / 360)) / height; // of a pixel at depth 1
        this.middle = [width / 2, height / 2];
    }
    point([x, y], depth) {
        const sideways = plus(
            times(this.right, (x - this.middle[0]) * this.scale),
            times(this.up, (y - this.middle[1]) * this.scale),
        );
        return plus(this.eye, times(plus(sideways, times(this.backward, -1)), depth));
    }
    pixel(point) {
        const p = plus(point, times(this.eye, -1)),
            depth = -dot(p, this.backward);
        return [
            this.middle[0] + dot(p, this.right) / depth / this.scale,
            this.middle[1] + dot(p, this.up) / depth / this.scale,
        ];
    }
}

// Face f: directions normal + a right + b down, a and b in [-1, 1].
const faces = [
    { normal: [1, 0, 0], right: [0, 0, -1], down: [0, -1, 0] },
    { normal: [-1, 0, 0], right: [0, 0, 1], down: [0, -1, 0] },
    { normal: [0, 1, 0], right: [1, 0, 0], down: [0, 0, 1] },
    { normal: [0, -1, 0], right: [1, 0, 0], down: [0, 0, -1] },
    { normal: [0, 0, 1], right: [1, 0, 0], down: [0, -1, 0] },
    { normal: [0, 0, -1], right: [-1, 0, 0], down: [0, -1, 0] },
];

function on_face(direction) {
    const along = faces.map(({ normal }) => dot(normal, direction)),
        face = along.indexOf(Math.max(...along));
    return {
        face,
        a: dot(faces[face].right, direction) / along[face],
        b: dot(faces[face].down, direction) / along[face],
    };
}

/** Maps as numbers: `value(map, face, row, column)` is RGB. */
export class Maps {
    constructor(n, count, value) {
        Object.assign(this, { n, count, value });
    }
    /**
     * Bilinear; beyond an edge lies the next face's texel, folded over; beyond a corner the mean of the three there.
     */
    at(map, direction) {
        const { face, a, b } = on_face(direction),
            n = this.n;
        const x = ((a + 1) / 2) * n - 0.5,
            y = ((b + 1) / 2) * n - 0.5,
            column = Math.floor(x),
            row = Math.floor(y);
        const texel = (r, c) => this.texel(map, face, r, c);
        return mix(
            mix(texel(row, column), texel(row, column + 1), x - column),
            mix(texel(row + 1, column), texel(row + 1, column + 1), x - column),
            y - row,
        );
    }
    texel(map, face, row, column) {
        const inside = i => Math.min(Math.max(i, 0), this.n - 1),
            r = inside(row),
            c = inside(column);
        if (r === row && c === column) return this.value(map, face, row, column);
        if (r === row || c === column) return this.folded(map, face, row, column);
        return times(
            [this.value(map, face, r, c), this.folded(map, face, row, c), this.folded(map, face, r, column)].reduce(
                plus,
            ),
            1 / 3,
        );
    }
    folded(map, face, row, column) {
        const centre = i => (2 * i + 1) / this.n - 1,
            limit = x => Math.min(Math.max(x, -1), 1);
        const a = centre(column),
            b = centre(row),
            over = Math.abs(a - limit(a)) + Math.abs(b - limit(b));
        const { normal, right, down } = faces[face];
        const next = on_face(plus(times(normal, 1 - over), plus(times(right, limit(a)), times(down, limit(b)))));
        const index = x => Math.round(((x + 1) / 2) * this.n - 0.5);
        return this.value(map, next.face, index(next.b), index(next.a));
    }
    diffuse(t) {
        return this.at(0, t);
    }
    specular(t, to_eye) {
        const last = this.count - 2,
            x = (last * Math.acos(Math.min(Math.max(dot(t, to_eye), -1), 1))) / Math.PI;
        const m = Math.min(Math.floor(x), last - 1);
        return mix(this.at(1 + m, t), this.at(2 + m, t), x - m);
    }
}

/** Turns v about world X, then Y, then Z, by degrees; `back` undoes it. */
export function turn(v, degrees, back = false) {
    const about = (axis, v) => {
        const angle = ((back ? -1 : 1) * degrees[axis] * Math.PI) / 180,
            [i, j] = [(axis + 1) % 3, (axis + 2) % 3],
            r = [...v];
        r[i] = Math.cos(angle) * v[i] - Math.sin(angle) * v[j];
        r[j] = Math.sin(angle) * v[i] + Math.cos(angle) * v[j];
        return r;
    };
    return (back ? [2, 1, 0] : [0, 1, 2]).reduce((v, axis) => about(axis, v), v);
}

/** Real orthonormal harmonics of four bands, l * l + l + m, from the associated Legendre recurrence. */
export function harmonics([x, y, z]) {
    const values = [],
        phi = Math.atan2(y, x),
        sine = Math.hypot(x, y);
    const factorial = k => (k < 2 ? 1 : k * factorial(k - 1));
    const legendre = (l, m) => {
        // without the Condon-Shortley phase
        if (l === m) return sine ** m * [1, 1, 3, 15][m];
        if (l < m) return 0;
        return ((2 * l - 1) * z * legendre(l - 1, m) - (l + m - 1) * legendre(l - 2, m)) / (l - m);
    };
    for (let l = 0; l < 4; l++)
        for (let m = -l; m <= l; m++) {
            const k = Math.abs(m),
                scale = ((2 * l + 1) / (4 * Math.PI)) * (factorial(l - k) / factorial(l + k));
            values.push(
                Math.sqrt(m ? 2 * scale : scale) * legendre(l, k) * (m < 0 ? Math.sin(k * phi) : Math.cos(k * phi)),
            );
        }
    return values;
}

// T of a bent cone: A / share within the half-angle, 0 outside, soft in the cosine; from A and A |b| axis.
function cone_seen(average, moment, light) {
    if (!(average > 0)) return 0;
    const b = Math.min(1, length(moment) / average),
        cosine = 2 * b - 1,
        border = Math.min(0.25, 1 - Math.abs(cosine));
    const inside = 1 - b > average ? average / (1 - b) : 1,
        beyond = dot(normalized(moment), light) - cosine;
    return inside * Math.min(Math.max(border > 0 ? 0.5 * (1 + beyond / border) : Math.sign(beyond), 0), 1);
}

/**
 * Light from a point {tangent, to_eye, average, sh, moment} to the eye. `scene`: {maps, scale, exponent, look, edit};
 * lights of the edit are {direction, irradiance}. `side`: the settings of one side of the viewer.
 */
export function radiance(point, scene, side) {
    if (side.part === 'transmittance') return [point.average, point.average, point.average];
    const { maps, look, edit } = scene,
        t = point.tangent;
    const kd = look.color.map(c => (side.part === 'specular' ? 0 : (c * look.albedo) / Math.PI ** 2));
    const ks = side.part === 'diffuse' ? 0 : look.specular,
        a = side.with_transmittance ? point.average : 1;
    const turned = turn(t, edit.rotation_deg, true);
    const d = maps.diffuse(turned),
        s = maps.specular(turned, turn(point.to_eye, edit.rotation_deg, true));
    const gain = edit.tint.map(c => c * 2 ** edit.exposure_stops * scene.scale);
    let sum = [0, 1, 2].map(c => a * gain[c] * (kd[c] * d[c] + ks * s[c]));
    for (const { direction, irradiance } of edit.lights) {
        const l = normalized(direction),
            sine = length(cross(t, l)),
            eye_sine = length(cross(t, point.to_eye));
        const lobe = Math.max(0, sine * eye_sine - dot(t, l) * dot(t, point.to_eye)) ** scene.exponent;
        const y = harmonics(l);
        const seen = !side.with_transmittance
            ? 1
            : side.hidden_by === 'harmonics'
              ? Math.min(
                    Math.max(
                        point.sh.reduce((t, c, i) => t + c * y[i], 0),
                        0,
                    ),
                    1,
                )
              : side.hidden_by === 'cone'
                ? cone_seen(point.average, point.moment, l)
                : point.average;
        sum = sum.map((x, c) => x + seen * irradiance[c] * (kd[c] * sine + ks * lobe));
    }
    return sum;
}
