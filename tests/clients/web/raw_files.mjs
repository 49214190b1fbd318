// Random maps and strands in the files of the output `raw` (core/output/raw_maps.h, raw_strands.h), and as numbers.
import { Maps } from './viewer_reference.mjs';

/** A seeded generator of numbers in [0, 1): Marsaglia's xorshift. */
export function generator(seed) {
    let state = seed >>> 0 || 1;
    return () => {
        state ^= state << 13;
        state ^= state >>> 17;
        state ^= state << 5;
        return (state >>> 0) / 2 ** 32;
    };
}

/** The half float next to x towards 0, of 0 and [2^-14, 65504]: { value, bits }. */
export function as_half(x) {
    const magnitude = Math.abs(x);
    if (magnitude < 2 ** -14) return { value: 0, bits: 0 };
    let exponent = 0;
    while (magnitude < 2 ** exponent) exponent--;
    while (magnitude >= 2 ** (exponent + 1)) exponent++;
    const mantissa = Math.floor((magnitude / 2 ** exponent - 1) * 1024);
    const value = (1 + mantissa / 1024) * 2 ** exponent;
    return { value: x < 0 ? -value : value, bits: (x < 0 ? 0x8000 : 0) | ((exponent + 15) << 10) | mantissa };
}

/** `count` maps of n x n texels, uniform in [0, 1]. {maps, files} */
export function random_maps(random, n, count, { scale, exponent }) {
    const bits = new Uint16Array(count * 6 * n * n * 4),
        values = new Float64Array(bits.length);
    for (let i = 0; i < bits.length; i++) {
        const half = as_half(i % 4 === 3 ? 1 : random());
        bits[i] = half.bits;
        values[i] = half.value;
    }
    const value = (map, face, row, column) => {
        const at = 4 * (((map * 6 + face) * n + row) * n + column);
        return [values[at], values[at + 1], values[at + 2]];
    };
    const page = { content: 'hairbake irradiance maps', shape: [count, 6, n, n, 4], scale, exponent };
    return {
        maps: new Maps(n, count, value),
        files: { 'maps.json': JSON.stringify(page), 'maps.f16': Buffer.from(bits.buffer) },
    };
}

/** Files of strands; `vertices` are {position, tangent, average, sh, cone} of numbers, `begin` where strands begin. */
export function strand_files(vertices, begin) {
    const arrays = [],
        pieces = [];
    let offset = 0;
    const add = (name, array) => {
        const padding = (8 - (offset % 8)) % 8;
        pieces.push(Buffer.alloc(padding), Buffer.from(array.buffer));
        offset += padding;
        arrays.push({ name, offset, bytes: array.byteLength });
        offset += array.byteLength;
    };
    const halves = of => Uint16Array.from(vertices.flatMap(of), x => as_half(x).bits);
    add('positions', Float32Array.from(vertices.flatMap(v => v.position)));
    add('strand_begin', Uint32Array.from(begin));
    add(
        'tangent_and_transmittance',
        halves(v => [...v.tangent, v.average]),
    );
    add(
        'transmittance_sh',
        halves(v => v.sh),
    );
    add(
        'bent_cone',
        halves(v => v.cone),
    );
    const bounds = [Math.min, Math.max].map(of => [0, 1, 2].map(axis => of(...vertices.map(v => v.position[axis]))));
    const page = {
        content: 'hairbake strands',
        vertices: vertices.length,
        strands: begin.length - 1,
        bounds,
        sh_bands: Math.sqrt(vertices[0].sh.length),
        arrays,
    };
    return { 'strands.json': JSON.stringify(page), 'strands.bin': Buffer.concat(pieces) };
}

/** Simulates the service for bakes of these files: an `answer` of support.mjs's serve(). */
export function bake_service(bakes) {
    return (method, path) => {
        const [, id, name] = path.match(/^\/v1\/bakes\/(\w+)(?:\/files\/([\w.]+))?$/) ?? [];
        if (!bakes[id]) return undefined;
        const { files, request = {}, names = {} } = bakes[id];
        if (name) return { type: 'application/octet-stream', body: files[name] };
        const view = {
            id,
            state: 'done',
            names,
            request: { hair: 'sha256:0', environment: 'sha256:1', outputs: ['raw'], ...request },
            files: Object.keys(files).map(file => ({ name: file, sha256: `${id} ${file}` })),
        };
        return { type: 'application/json', body: JSON.stringify(view) };
    };
}
