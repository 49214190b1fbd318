// Cube maps as one 2-D texture array: a layer is a map, its six faces are cells of 3 x 2, and every cell has a border
// of one texel, so that the card's bilinear filter crosses a face's edge as core's sample_cube does.
//
// Cube samplers cannot be used: WebGL 2 has no arrays of cube maps and cannot choose a sampler by a computed index, and
// three.js negates x in cube look-ups. Faces are those of core/environment/cube_map.h.
import { face_direction, texel_of } from '../app/result/cube.js';
import { from_half, to_half } from './half_float.js';

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
    for (let face = 0; face < 6; face++) {
        const left = (face % atlas_columns) * cell + 1,
            top = Math.floor(face / atlas_columns) * cell + 1;
        const border = border_of(n, face);
        for (let map = 0; map < maps; map++) {
            const to = (row, column) => 4 * ((map * height + top + row) * width + left + column);
            const begin = map * 6 * n * n;
            for (let row = 0; row < n; row++) {
                const from = 4 * (begin + texel_index(n, face, row, 0));
                data.set(texels.subarray(from, from + 4 * n), to(row, 0));
            }
            for (const { row, column, from } of border) put_mean(texels, begin, from, data, to(row, column));
        }
    }
    return { data, width, height, layers: maps };
}

// The texels of the border around a face: {row, column, from}. Each is the mean of the texels `from`.
function border_of(n, face) {
    const border = [];
    for (let i = -1; i <= n; i++) {
        for (const end of [-1, n]) border.push([end, i]);
        if (i >= 0 && i < n) for (const end of [-1, n]) border.push([i, end]);
    }
    return border.map(([row, column]) => ({ row, column, from: sources(n, face, row, column) }));
}

// The sources of the border texel (row, column): the neighbour across the edge; at a corner the three texels that meet.
function sources(n, face, row, column) {
    const r = Math.min(Math.max(row, 0), n - 1),
        c = Math.min(Math.max(column, 0), n - 1);
    if (r === row || c === column) return [across(n, face, row, column)];
    return [texel_index(n, face, r, c), across(n, face, row, c), across(n, face, r, column)];
}

function texel_index(n, face, row, column) {
    return (face * n + row) * n + column;
}

// A step of a thousandth of a texel beyond the edge lands in the neighbour and moves less than that along the edge.
function across(n, face, row, column) {
    const limit = 1 + 2e-3 / n;
    const coordinate = i => Math.min(Math.max((2 * i + 1) / n - 1, -limit), limit);
    const neighbour = texel_of(face_direction(face, coordinate(column), coordinate(row)), n);
    return texel_index(n, neighbour.face, neighbour.j, neighbour.i);
}

function put_mean(texels, begin, from, data, to) {
    for (let channel = 0; channel < 4; channel++)
        data[to + channel] = to_half(mean(from.map(texel => from_half(texels[4 * (begin + texel) + channel]))));
}

function mean(values) {
    return values.reduce((sum, value) => sum + value, 0) / values.length;
}
