// The page's pure functions, in node.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { request_by_names } from '../../../clients/web/app/bake/by_names.js';
import {
    build_request,
    differences,
    first_values,
    merged,
    names_of,
    reference_to,
    with_value,
} from '../../../clients/web/app/bake/request.js';
import { defaults_of, faults, fields_of, range_text } from '../../../clients/web/app/bake/schema.js';
import { names_by_digest, versions_by_path, warnings } from '../../../clients/web/app/input_facts.js';
import { wait_ms_of } from '../../../clients/web/app/retry.js';
import {
    face_direction,
    latlong_direction,
    layout_of,
    net_texel,
    texel_direction,
    texel_of,
} from '../../../clients/web/app/result/cube.js';
import { srgb_byte } from '../../../clients/web/app/result/map_set.js';
import { read_route } from '../../../clients/web/app/routes.js';
import { from_half, half_values } from '../../../clients/web/viewer/half_float.js';
import { name_from_file } from '../../../clients/web/app/name_text.js';
import { bytes_text, number_text } from '../../../clients/web/app/number_text.js';
import { duration_text } from '../../../clients/web/app/time_text.js';

const config = new URL('../../../config/', import.meta.url);
const schema = JSON.parse(readFileSync(new URL('request.schema.json', config)));

test('half floats mean what IEEE 754 says', () => {
    // sign, five bits of exponent (bias 15), ten of fraction
    for (const [bits, value] of [
        [0x0000, 0],
        [0x3c00, 1],
        [0xc000, -2],
        [0x3555, 0.333251953125],
        [0x7bff, 65504],
        [0x0400, 2 ** -14],
        [0x03ff, (1023 / 1024) * 2 ** -14],
        [0x0001, 2 ** -24],
        [0x7c00, Infinity],
        [0xfc00, -Infinity],
    ])
        assert.equal(from_half(bits), value);
    assert.ok(Number.isNaN(from_half(0x7e00)));
    assert.ok(Object.is(from_half(0x8000), -0));
    assert.deepEqual([...half_values(new Uint16Array([0, 0, 0, 0x3c00, 0, 0, 0, 0x4000]), 3, 4)], [1, 2]);
});

test('a direction through any texel finds that texel', () => {
    const n = 5;
    for (let face = 0; face < 6; ++face)
        for (let j = 0; j < n; ++j)
            for (let i = 0; i < n; ++i)
                assert.deepEqual(texel_of(texel_direction({ face, i, j }, n), n), { face, i, j });
});

test('neighbours in the net are neighbours on the cube', () => {
    // Two pixels side by side in different faces: their directions differ by about one texel, 2 / n at most twice that.
    const n = 32;
    const { width, height } = layout_of('net', n);
    let edges = 0;
    for (let y = 0; y < height; ++y)
        for (let x = 0; x + 1 < width; ++x) {
            const [left, right] = [net_texel(x, y, n), net_texel(x + 1, y, n)];
            if (!left || !right || left.face === right.face) continue;
            ++edges;
            const [a, b] = [texel_direction(left, n), texel_direction(right, n)];
            assert.ok(Math.hypot(...a.map((t, k) => t - b[k])) < 4 / n, `${x}, ${y}`);
        }
    assert.equal(edges, 3 * n); // the middle row has three edges between four faces
    const middle = (c, r) => net_texel(c * n + 1, r * n + 1, n)?.face;
    assert.deepEqual(
        [middle(1, 0), middle(0, 1), middle(1, 1), middle(2, 1), middle(3, 1), middle(1, 2), middle(0, 0)],
        [2, 1, 4, 0, 5, 3, undefined],
    );
    // +Y lies above +Z: its lowest row looks almost along +Z.
    const above = texel_direction(net_texel(n + n / 2, n - 1, n), n);
    assert.ok(above[1] > 0.7 && above[2] > 0.65);
});

test('the lat-long picture has +Y on top, +X in the centre, +Z right of it', () => {
    const at = (x, y) => latlong_direction(x, y, 400, 200).map(t => Math.round(t * 50) / 50); // a pixel is 0.016
    assert.deepEqual(at(199.5, 99.5), [1, 0, 0]);
    assert.deepEqual(at(299.5, 99.5), [0, 0, 1]);
    assert.deepEqual(at(99.5, 99.5).map(Math.abs), [0, 0, 1]);
    assert.equal(at(17, -0.5)[1], 1);
    assert.deepEqual(face_direction(4, 0, 0), [0, -0, 1]);
});

test('sRGB bytes are those of IEC 61966-2-1', () => {
    // ((128 / 255 + 0.055) / 1.055)^2.4 = 0.21586
    for (const [value, byte] of [
        [0, 0],
        [-1, 0],
        [NaN, 0],
        [1, 255],
        [7, 255],
        [0.21586, 128],
        [0.001, 3],
    ])
        assert.equal(srgb_byte(value), byte);
});

test('every field of the schema has a help text, and what is a number has a range', () => {
    const fields = fields_of(schema);
    assert.ok(fields.length > 30);
    for (const { path, schema: field } of fields) {
        assert.ok(field.description?.length > 5, path.join('.'));
        if (field.type === 'number' || field.type === 'integer' || field.anyOf)
            assert.match(range_text(field), /^(more than )?[-\d.e+]+,? (up )?to /, path.join('.'));
    }
});

test('the defaults follow the schema, and a request of defaults names files and outputs alone', () => {
    const values = { ...first_values(schema), hair: 'sha256:aa' };
    assert.deepEqual(faults(schema, defaults_of(schema)), []);
    assert.deepEqual(build_request(schema, values), { hair: 'sha256:aa', outputs: ['npy', 'exr', 'hair', 'raw'] });
});

test('a preset and a change make a request of what differs', () => {
    const draft = JSON.parse(readFileSync(new URL('presets/draft.json', config))).request;
    const base = merged(first_values(schema), draft);
    const values = with_value(base, ['irradiance', 'rotation_deg'], [0, 90, 0]);
    assert.deepEqual(build_request(schema, values), {
        transmittance: { directions: 32, voxels: 128, reference_vertices: 64 },
        irradiance: { face_size: 8, specular_maps: 17, rotation_deg: [0, 90, 0] },
        outputs: ['npy', 'exr', 'hair', 'raw'],
    });
    assert.deepEqual(differences(schema, values, base), ['irradiance.rotation_deg']);
    for (const name of readdirSync(new URL('presets/', config)))
        assert.deepEqual(
            faults(schema, JSON.parse(readFileSync(new URL(`presets/${name}`, config))).request),
            [],
            name,
        );
});

test('what the schema does not allow is named by field, with what is allowed', () => {
    const wrong = request => faults(schema, request).map(({ path, message }) => `${path} ${message}`);
    assert.deepEqual(wrong({ irradiance: { face_size: 3 } }), [
        'irradiance.face_size is 3; allowed is 4 to 256, whole',
    ]);
    assert.deepEqual(wrong({ irradiance: { face_size: 4.5 } }), [
        'irradiance.face_size is 4.5; allowed is 4 to 256, whole',
    ]);
    assert.deepEqual(wrong({ transmittance: { directions: null } }), [
        'transmittance.directions is empty; allowed is 1 to 4096, whole',
    ]);
    assert.deepEqual(wrong({ strand: { width: 0 } }), ['strand.width is 0; allowed is more than 0, up to 1e18']);
    assert.deepEqual(wrong({ strand: { opacity: 'from_file', width: null } }), []);
    assert.deepEqual(wrong({ strand: { opacity: 2 } }), ['strand.opacity is 2; allowed is 0 to 1, or from_file']);
    assert.deepEqual(wrong({ irradiance: { tint: [1, 2, -1] } }), ['irradiance.tint.2 is -1; allowed is 0 to 1000000']);
    assert.deepEqual(wrong({ irradiance: { tint: [1] } }), ['irradiance.tint has 1 entries; allowed are 3 to 3']);
    assert.deepEqual(wrong({ irradiance: { lights: [{ direction: [0, 1, 0] }] } }), [
        'irradiance.lights.0.irradiance is missing',
    ]);
    assert.deepEqual(wrong({ outputs: ['npy', 'npy'] }), ['outputs holds something twice']);
    assert.deepEqual(wrong({ colour: 1, toString: 2 }), ['colour is not a field', 'toString is not a field']);
});

test('warnings tell of pixels that a bake refuses and of a low range', () => {
    const facts = { invalid_pixels: { negative: 3, nan: 1, infinite: 0 }, low_dynamic_range: true, warnings: ['x'] };
    assert.deepEqual(warnings({ kind: 'environment', facts }), [
        'x',
        '1 pixel infinite or not a number.',
        'A bake refuses such pixels unless its invalid radiance is "clamp".',
        'Its dynamic range is low: lamps are clipped.',
    ]);
    assert.deepEqual(warnings({ kind: 'environment', facts: { small_lights: { pixels: 14, share: 0.583 } } }), [
        'A sun or small lamps: 14 pixels hold 58 % of the light.',
    ]);
    assert.deepEqual(warnings({ kind: 'model', facts: { warnings: ['no width'] } }), ['no width']);
});

test('numbers, sizes, times and names read well', () => {
    assert.deepEqual([0, 999, 1500, 24100128, 999.6e6].map(bytes_text), [
        '0 bytes',
        '999 bytes',
        '1.5 kB',
        '24 MB',
        '1.0 GB',
    ]);
    assert.deepEqual([0.1234, 5.04, 62, 600, 7200].map(duration_text), ['123 ms', '5.0 s', '62 s', '10 min', '2.0 h']);
    assert.deepEqual(
        [0, 0.00001234, 3.14159, 123456, 1e9].map(x => number_text(x)),
        ['0', '1.234e-5', '3.142', '123500', '1.000e+9'],
    );
    assert.equal(name_from_file('../My <sky> (1k).hdr'), 'My-sky-1k');
    assert.equal(name_from_file('.hdr'), '');
});

test('addresses are taken apart, broken ones too', () => {
    assert.deepEqual(read_route('#/bakes/ab%20c?x=1'), { path: ['bakes', 'ab c'], query: { x: '1' } });
    assert.deepEqual(read_route('#/names/%zz'), { path: ['names', '%zz'], query: {} });
    assert.deepEqual(read_route(''), { path: [], query: {} });
});

test('a request asks by the first name of a file in its version, by the chosen one, or by digest', () => {
    const list = [
        { path: 'stage/dawn', sha256: 'abc', version: 3 },
        { path: 'stage/dusk', sha256: 'abc', version: 1 },
    ];
    const inputs = { names: names_by_digest(list), versions: versions_by_path(list) };
    assert.deepEqual(names_of('abc', inputs), ['name:stage/dawn@3', 'name:stage/dusk@1']);
    assert.deepEqual(names_of('def', inputs), []);
    assert.equal(reference_to({ id: '' }, inputs), null);
    assert.equal(reference_to({ id: 'abc' }, inputs), 'name:stage/dawn@3');
    assert.equal(reference_to({ id: 'abc', by: 'name:stage/dusk@1' }, inputs), 'name:stage/dusk@1');
    assert.equal(reference_to({ id: 'abc', by: 'name:gone@1' }, inputs), 'name:stage/dawn@3');
    assert.equal(reference_to({ id: 'abc', by: '' }, inputs), 'sha256:abc');
    assert.equal(reference_to({ id: 'def' }, inputs), 'sha256:def');
});

test('the request of a bake names what it was asked by, in the version that it had', () => {
    const request = { hair: 'sha256:a', environment: 'sha256:b', occluder: null, outputs: ['raw'] };
    const names = { environment: { path: 'stage/dawn', version: 2 } };
    assert.deepEqual(request_by_names({ request, names }), { ...request, environment: 'name:stage/dawn@2' });
    assert.deepEqual(request_by_names({ request, names: {} }), request);
});

test('Retry-After is read in seconds and as a date, and no wait is longer than two minutes', () => {
    assert.deepEqual([null, '', 'soon', '0', '-5'].map(wait_ms_of), [0, 0, 0, 0, 0]);
    assert.equal(wait_ms_of('60'), 60_000);
    assert.equal(wait_ms_of('999999'), 120_000);
    const wait = wait_ms_of(new Date(Date.now() + 30_000).toUTCString()); // in whole seconds
    assert.ok(wait > 20_000 && wait <= 30_000, `${wait} ms`);
    assert.equal(wait_ms_of('Wed, 21 Oct 2015 07:28:00 GMT'), 0);
});
