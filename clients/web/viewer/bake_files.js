// A bake as the viewer needs it: its request, and the files of the output `raw` as typed arrays. Anyone may write to
// the service, so each number of a file is checked against the size of the array that it describes.

import { request_by_names } from '../app/bake/by_names.js';
import { from_half } from './half_float.js';

const needed = ['strands.json', 'strands.bin', 'maps.json', 'maps.f16'];

/** A bake that cannot be shown. message: for the user; request: a request that would help, or null. */
export class BakeProblem extends Error {
    constructor(message, request = null) {
        super(message);
        this.request = request;
    }
}

/**
 * Loads a finished bake: { id, names, model, environment, request, strands, maps }; strands and maps are read from the
 * files, the rest is as the service sends it.
 * known: bakes loaded before; strands or maps of the same digest are not fetched again but are the same objects;
 * say(text): called with each step.
 *
 * Throws BakeProblem.
 */
export async function load_bake(api, id, { known = [], signal, say = () => {} } = {}) {
    say('Fetching the bake.');
    const view = await api.json(`/v1/bakes/${id}`, { signal });
    refuse_unfit(view);
    const digest = name => view.files.find(file => file.name === name).sha256;
    const fetched = async (kind, json, bytes, read) => {
        const same = known.map(bake => bake[kind]).find(object => object.digest && object.digest === digest(bytes));
        if (same) return same;
        say(`Fetching ${bytes}.`);
        const page = await get(api, id, json, signal, reply => reply.json());
        const buffer = await get(api, id, bytes, signal, reply => reply.arrayBuffer());
        return { digest: digest(bytes), ...read(page, buffer) };
    };
    return {
        id,
        names: view.names,
        model: view.model,
        environment: view.environment,
        request: view.request,
        strands: await fetched('strands', 'strands.json', 'strands.bin', read_strands),
        maps: await fetched('maps', 'maps.json', 'maps.f16', read_maps),
    };
}

function refuse_unfit(view) {
    if (view.state !== 'done')
        throw new BakeProblem(`This bake is ${view.state}, not done: there is nothing to show yet.`);
    const missing = ['hair', 'environment'].filter(input => !view.request[input]);
    if (missing.length)
        throw new BakeProblem(
            `This bake has no ${missing.join(' and no ')}. The viewer needs both: ask for a bake of a hair model and ` +
                'an environment, with "raw" among its outputs.',
        );
    const names = new Set(view.files.map(file => file.name));
    if (needed.some(name => !names.has(name)))
        throw new BakeProblem(
            'This bake did not write the output "raw", which the viewer reads. Ask for the same bake with ' +
                '"raw" among its outputs. It is computed again.',
            { ...request_by_names(view), outputs: [...new Set([...view.request.outputs, 'raw'])] },
        );
}

async function get(api, id, name, signal, body) {
    try {
        const reply = await api.ask(api.file_url(id, name), { signal });
        if (!reply.ok) throw new Error(`HTTP status ${reply.status}.`);
        return await body(reply);
    } catch (error) {
        if (signal?.aborted) throw error;
        throw new BakeProblem(`${name} of this bake could not be fetched: ${error.message}`);
    }
}

/**
 * {vertices, bounds, sh_bands, has_cone, positions, strand_begin, tangent_and_transmittance, transmittance_sh?,
 * bent_cone?}.
 */
export function read_strands(page, buffer) {
    const vertices = page.vertices;
    demand(page.content === 'hairbake strands', 'strands.json is no list of strands');
    demand(Number.isInteger(vertices) && vertices > 0, 'strands.json has no vertices to draw');
    const array = (name, Type, size) => named_array(page, buffer, name, Type, size);
    const strands = {
        vertices,
        bounds: page.bounds,
        sh_bands: page.sh_bands,
        has_cone: page.arrays.some(entry => entry.name === 'bent_cone'),
        positions: array('positions', Float32Array, 3 * vertices),
        strand_begin: array('strand_begin', Uint32Array, page.strands + 1),
        tangent_and_transmittance: array('tangent_and_transmittance', Uint16Array, 4 * vertices),
    };
    demand([0, 1, 2, 3, 4].includes(page.sh_bands), 'strands.json: sh_bands is not 0 to 4');
    if (page.sh_bands) strands.transmittance_sh = array('transmittance_sh', Uint16Array, page.sh_bands ** 2 * vertices);
    if (strands.has_cone) strands.bent_cone = array('bent_cone', Uint16Array, 4 * vertices);
    refuse_strands(strands.strand_begin, vertices);
    return strands;
}

/**
 * { texels, face_size, count, scale, exponent, level }. count: number of maps, the diffuse one is first;
 * level: mean of the diffuse map, to one digit.
 */
export function read_maps(page, buffer) {
    demand(page.content === 'hairbake irradiance maps', 'maps.json is no list of maps');
    const [count, faces, n] = page.shape;
    demand(faces === 6 && Number.isInteger(n) && n > 0 && n <= 4096, 'maps.json: the shape is not that of cube maps');
    demand(Number.isInteger(count) && count >= 3, 'maps.json: a diffuse and two specular maps are the least');
    demand(page.scale > 0 && page.exponent >= 0, 'maps.json: scale or exponent is out of range');
    demand(buffer.byteLength === count * 6 * n * n * 8, 'maps.f16 does not have the size that maps.json states');
    const texels = new Uint16Array(buffer),
        level = page.scale * mean_green(texels.subarray(0, 6 * n * n * 4));
    return { texels, face_size: n, count, scale: page.scale, exponent: page.exponent, level: one_digit(level) };
}

function mean_green(texels) {
    let sum = 0;
    for (let i = 1; i < texels.length; i += 4) sum += from_half(texels[i]);
    return sum / (texels.length / 4);
}

// 1 for a map without light.
function one_digit(value) {
    return value > 0 && Number.isFinite(value) ? Number(value.toPrecision(1)) : 1;
}

function named_array(page, buffer, name, Type, size) {
    const entry = page.arrays.find(array => array.name === name);
    demand(entry, `strands.json has no array ${name}`);
    const bytes = size * Type.BYTES_PER_ELEMENT;
    demand(
        entry.bytes === bytes && entry.offset % 8 === 0 && entry.offset + bytes <= buffer.byteLength,
        `strands.bin does not hold ${name} as strands.json states`,
    );
    return new Type(buffer, entry.offset, size);
}

function refuse_strands(strand_begin, vertices) {
    const ordered = strand_begin.every((begin, s) => s === 0 || begin >= strand_begin[s - 1]);
    demand(
        strand_begin[0] === 0 && ordered && strand_begin[strand_begin.length - 1] === vertices,
        'strands.bin: strand_begin does not divide the vertices',
    );
}

function demand(holds, problem) {
    if (!holds) throw new BakeProblem(`The bake's files do not fit together: ${problem}.`);
}
