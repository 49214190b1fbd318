// Cube maps as one 2-D texture array: a layer is a map, its six faces are cells of 3 x 2, and every cell has a border
// of one texel, so that the card's own bilinear filter goes on across a face's edge as core's sample_cube does.
//
// WebGL 2 has no cube map arrays, a sampler cannot be chosen by a computed number, and three.js negates x in its cube
// look-ups: hence no cube samplers. Faces are those of core/environment/cube_map.h.
import { from_half, to_half } from './half.js';

export const atlas_columns = 3,
    atlas_rows = 2;

/**
 * `texels` are the halves of maps.f16 [maps, 6, n, n, 4]. Gives {data, width, height, layers}: halves [layers, height,
 * width, 4], rows from the top.
 */
export function cube_atlas(texels, n, maps) {
    const cell = n + 2,
        width = atlas_columns * cell,
        height = atlas_rows * cell;
    const data = new Uint16Array(maps * width * height * 4);
    const faces = [0, 1, 2, 3, 4, 5];
    for (const face of faces)
        for (let row = -1; row <= n; row++)
            for (let column = -1; column <= n; column++) {
                const x = (face % atlas_columns) * cell + column + 1;
                const y = Math.floor(face / atlas_columns) * cell + row + 1;
                const from = sources(n, face, row, column);
                for (let map = 0; map < maps; map++)
                    put(texels, map * 6 * n * n, from, data, 4 * ((map * height + y) * width + x));
            }
    return { data, width, height, layers: maps };
}

// Texels of a map whose mean is wanted at (row, column), which may lie one beyond the face: the neighbour across the
// edge, and beyond a corner, where three faces meet, the mean of the three texels there.
function sources(n, face, row, column) {
    const r = Math.min(Math.max(row, 0), n - 1),
        c = Math.min(Math.max(column, 0), n - 1);
    const row_inside = r === row,
        column_inside = c === column;
    if (row_inside && column_inside) return [texel_index(n, face, row, column)];
    if (row_inside || column_inside) return [across(n, face, row, column)];
    return [texel_index(n, face, r, c), across(n, face, row, c), across(n, face, r, column)];
}

function texel_index(n, face, row, column) {
    return (face * n + row) * n + column;
}

// A step of a thousandth of a texel beyond the edge lands in the neighbour and moves less than that along the edge.
function across(n, face, row, column) {
    const limit = 1 + 2e-3 / n;
    const coordinate = i => Math.min(Math.max((2 * i + 1) / n - 1, -limit), limit);
    const [to, a, b] = cube_point(cube_vector(face, coordinate(column), coordinate(row)));
    const index = x => Math.min(Math.max(Math.floor(((x + 1) / 2) * n), 0), n - 1);
    return texel_index(n, to, index(b), index(a));
}

function cube_vector(face, a, b) {
    return [
        [1, -b, -a],
        [-1, -b, a],
        [a, 1, b],
        [a, -1, -b],
        [a, -b, 1],
        [-a, -b, -1],
    ][face];
}

function cube_point([x, y, z]) {
    const mx = Math.abs(x),
        my = Math.abs(y),
        mz = Math.abs(z);
    if (mx >= my && mx >= mz) return x > 0 ? [0, -z / mx, -y / mx] : [1, z / mx, -y / mx];
    if (my >= mz) return y > 0 ? [2, x / my, z / my] : [3, x / my, -z / my];
    return z > 0 ? [4, x / mz, -y / mz] : [5, -x / mz, -y / mz];
}

function put(texels, map_begin, from, data, to) {
    for (let channel = 0; channel < 4; channel++) {
        const halves = from.map(texel => texels[4 * (map_begin + texel) + channel]);
        data[to + channel] = halves.length === 1 ? halves[0] : to_half(mean(halves.map(from_half)));
    }
}

function mean(values) {
    return values.reduce((sum, value) => sum + value, 0) / values.length;
}
