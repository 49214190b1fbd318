// Layouts of a cube map as a picture: net and lat-long. Faces are +X -X +Y -Y +Z -Z in OpenGL orientation.

export const face_names = ['+X', '-X', '+Y', '-Y', '+Z', '-Z'];

/** The direction at (a, b) of a face, a to the right and b down, both in [-1, 1]; not of length 1. */
export function face_direction(face, a, b) {
    return [
        [1, -b, -a],
        [-1, -b, a],
        [a, 1, b],
        [a, -1, -b],
        [a, -b, 1],
        [-a, -b, -1],
    ][face];
}

/** The texel { face, i, j } (column i, row j) of an n x n x 6 cube that a direction meets. */
export function texel_of(direction, n) {
    const [x, y, z] = direction;
    const [ax, ay, az] = direction.map(Math.abs);
    let face, a, b;
    if (ax >= ay && ax >= az) [face, a, b] = x > 0 ? [0, -z / ax, -y / ax] : [1, z / ax, -y / ax];
    else if (ay >= az) [face, a, b] = y > 0 ? [2, x / ay, z / ay] : [3, x / ay, -z / ay];
    else [face, a, b] = z > 0 ? [4, x / az, -y / az] : [5, -x / az, -y / az];
    const index = t => Math.min(n - 1, Math.floor(((t + 1) / 2) * n));
    return { face, i: index(a), j: index(b) };
}

// [column, row] of each face in a net of 4 x 3 around +Z.
const net_cells = [
    [2, 1],
    [0, 1],
    [1, 0],
    [1, 2],
    [1, 1],
    [3, 1],
];

/** The texel at pixel (x, y) of a net of 4n x 3n pixels; null outside of the faces. */
export function net_texel(x, y, n) {
    const column = Math.floor(x / n);
    const row = Math.floor(y / n);
    const face = net_cells.findIndex(([c, r]) => c === column && r === row);
    return face < 0 ? null : { face, i: x - column * n, j: y - row * n };
}

/** The direction at pixel (x, y) of a lat-long picture: row 0 is +Y, the centre column +X, right of it +Z. */
export function latlong_direction(x, y, width, height) {
    const phi = ((x + 0.5) / width - 0.5) * 2 * Math.PI;
    const theta = ((y + 0.5) / height) * Math.PI;
    return [Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi)];
}

/** The layout of a map of n x n x 6 as a picture: { width, height, texel(x, y) }. kind: 'net' or 'latlong'. */
export function layout_of(kind, n) {
    if (kind === 'net') return { width: 4 * n, height: 3 * n, texel: (x, y) => net_texel(x, y, n) };
    const width = 16 * n;
    const height = 8 * n;
    return { width, height, texel: (x, y) => texel_of(latlong_direction(x, y, width, height), n) };
}

/** Unit direction of a texel's centre. */
export function texel_direction({ face, i, j }, n) {
    const direction = face_direction(face, (2 * (i + 0.5)) / n - 1, (2 * (j + 0.5)) / n - 1);
    const length = Math.hypot(...direction);
    return direction.map(x => x / length);
}
