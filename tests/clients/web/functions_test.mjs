// The page's pure functions about pictures, texts and addresses, in node.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { phase_text, stage_counts_text, stage_title } from '../../../clients/web/app/bake/stage_text.js';
import { force_question, needed_lines } from '../../../clients/web/app/deletion.js';
import { warnings } from '../../../clients/web/app/input_facts.js';
import { name_from_file, title_text } from '../../../clients/web/app/name_text.js';
import { bytes_text, count_text, number_text } from '../../../clients/web/app/number_text.js';
import { accuracy_rows } from '../../../clients/web/app/result/accuracy.js';
import {
    face_direction,
    latlong_direction,
    layout_of,
    net_texel,
    texel_direction,
    texel_of,
} from '../../../clients/web/app/result/cube.js';
import { srgb_byte } from '../../../clients/web/app/result/map_set.js';
import { wait_ms_of } from '../../../clients/web/app/retry.js';
import { read_route } from '../../../clients/web/app/routes.js';
import { duration_text } from '../../../clients/web/app/time_text.js';
import { from_half, half_values } from '../../../clients/web/viewer/half_float.js';

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

test('Retry-After is read in seconds and as a date, and no wait is longer than two minutes', () => {
    assert.deepEqual([null, '', 'soon', '0', '-5'].map(wait_ms_of), [0, 0, 0, 0, 0]);
    assert.equal(wait_ms_of('60'), 60_000);
    assert.equal(wait_ms_of('999999'), 120_000);
    const wait = wait_ms_of(new Date(Date.now() + 30_000).toUTCString()); // in whole seconds
    assert.ok(wait > 20_000 && wait <= 30_000, `${wait} ms`);
    assert.equal(wait_ms_of('Wed, 21 Oct 2015 07:28:00 GMT'), 0);
});

test('names of fields become titles', () => {
    assert.deepEqual(
        ['face_size', 'sh_bands', 'rotation_deg', 'kajiya_kay', 'environment_settings'].map(title_text),
        ['Face size', 'SH bands', 'Rotation', 'Kajiya-Kay', 'Environment settings'],
    );
});

test('the accuracy of a result names every error that its manifest states', () => {
    const bar = { rmse: 0.01234, bias: -0.002, ci95: { rmse: [0.01, 0.015], bias: [-0.003, -0.001] } };
    assert.deepEqual(accuracy_rows({ error_bar: { ...bar, vertices: 256, directions: 1 } }), [
        ['A against traced strands, RMSE', '0.0123 (95 %: 0.01 to 0.015)'],
        ['Bias', '-0.002 (95 %: -0.003 to -0.001)'],
        ['Measured with', '256 vertices, 1 direction each'],
    ]);
    assert.deepEqual(accuracy_rows({ error_bar: { ...bar, noise: 0.0031, vertices: 2, directions: 4096 } }).slice(2), [
        ['Noise of the reference, taken off', '0.0031'],
        ['Measured with', `2 vertices, ${count_text(4096, 'direction')} each`],
    ]);
    assert.deepEqual(accuracy_rows({ error_bar: { vertices: 0 } }), [
        ['A against traced strands', 'not measured: every vertex drawn lies inside another strand'],
    ]);
    // As core/output/manifest.cpp writes it for the methods exact and sh.
    const exact = { face_size: 16, interpolation_bound_relative: 0.0042, environment_sh_bands: 8 };
    const bound = ['Between specular maps, at most', '0.42 % of the largest value'];
    assert.deepEqual(accuracy_rows({ error_bar: null, irradiance: exact }), [bound]);
    const sh = {
        ...exact,
        sh_bands: { diffuse: 3, specular: 18 },
        predicted_error: { diffuse: 0.00123, specular: 0.0095 },
    };
    assert.deepEqual(accuracy_rows({ error_bar: null, irradiance: sh }), [
        bound,
        ['SH bands', 'diffuse 3, specular 18'],
        ['Predicted SH error of the diffuse map, RMS', '0.123 % of the largest value'],
        ['Predicted SH error of the specular maps, RMS', '0.95 % of the largest value'],
    ]);
    assert.deepEqual(accuracy_rows({ error_bar: null }), []);
});

test('any number of stages is shown, also one that the page has no text for', () => {
    assert.equal(
        stage_counts_text({ transmittance: 1, irradiance: 2, guide_hairs: 3 }),
        '1 transmittance, 2 sets of irradiance maps, 3 guide_hairs',
    );
    assert.equal(stage_counts_text({ irradiance: 0 }), '0 sets of irradiance maps');
    assert.deepEqual(
        ['transmittance', 'irradiance', 'guide_hairs', 'toString'].map(stage_title),
        ['Transmittance', 'Irradiance maps', 'Guide hairs', 'ToString'],
    );
    assert.deepEqual(
        [
            { state: 'running', phase: 'read_hair' },
            { state: 'running' },
            { state: 'queued' },
            { state: 'queued', trouble: 'No space left' },
            { state: 'done', phase: 'write' },
        ].map(phase_text),
        ['Read hair', 'starting', 'queued', 'waits, because the machine is in trouble (No space left)', 'done'],
    );
});

test('the question before a deletion lists what refers to the input, and how much more there is', () => {
    const needed_by = {
        bakes: { count: 3, first: [{ id: 'a'.repeat(64), state: 'done' }] },
        names: { count: 1, first: [{ kind: 'mesh', path: 'heads/round', version: 2 }] },
    };
    const lines = ['name mesh/heads/round, version 2', 'bake aaaaaaaaaaaa (done)', 'and 2 more bakes'];
    assert.deepEqual(needed_lines({ needed_by }), lines);
    assert.ok(force_question('head.obj', { needed_by }).startsWith(`head.obj is needed:\n${lines.join('\n')}\n`));
    assert.deepEqual(needed_lines({ needed_by: null }), []);
});
