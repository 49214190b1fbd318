// The arithmetic behind the viewer: rotations and requests, polynomials, half floats. No browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { EditOrders, arrange } from '../../../clients/web/viewer/edit_orders.js';
import { from_half, to_half } from '../../../clients/web/viewer/half_float.js';
import {
    compose_request,
    lighting_text,
    multiply,
    no_edit,
    rotation_degrees,
    rotation_matrix,
    transform,
} from '../../../clients/web/viewer/lighting_edit.js';
import { angle_polynomial, harmonics, sine_polynomial } from '../../../clients/web/viewer/shader_math.js';
import { generator } from './raw_files.mjs';
import * as reference from './viewer_reference.mjs';

const random = generator(5);
const angle = () => 360 * random() - 180;

function assert_near(found, expected, tolerance, what) {
    found
        .flat()
        .forEach((x, i) =>
            assert.ok(Math.abs(x - expected.flat()[i]) <= tolerance, `${what}: ${found} and ${expected}`),
        );
}

test('A rotation turns about world X first, then Y, then Z', () => {
    // About X by 90 degrees y goes to z, about Y z to x, about Z x to y.
    assert_near(transform(rotation_matrix([90, 90, 0]), [0, 1, 0]), [1, 0, 0], 1e-15, 'y to z to x');
    assert_near(transform(rotation_matrix([0, 90, 90]), [0, 0, 1]), [0, 1, 0], 1e-15, 'z to x to y');
    for (let i = 0; i < 100; i++) {
        const degrees = [angle(), angle(), angle()],
            v = [random(), random(), random()];
        assert_near(
            transform(rotation_matrix(degrees), v),
            reference.turn(v, degrees),
            1e-14,
            'turned about one axis after the other',
        );
    }
});

test('Every rotation matrix comes back from its angles, also where Y is turned by 90 degrees', () => {
    const cases = Array.from({ length: 300 }, () => [angle(), angle(), angle()]);
    for (const degrees of [...cases, [30, 90, 40], [30, -90, 40], [0, 90, 0], [180, 0, 180], [0, 0, 0]]) {
        const matrix = rotation_matrix(degrees);
        // Angles are written with twelve digits.
        assert_near(rotation_matrix(rotation_degrees(matrix)), matrix, 1e-10, `angles ${degrees}`);
    }
});

test('An edit is applied to all that was baked: rotations in order, factors multiplied, lights turned', () => {
    const edit = {
        rotation_deg: [15, -120, 200],
        exposure_stops: 1,
        tint: [0.5, 1, 3],
        lights: [{ azimuth_deg: 90, elevation_deg: 0, irradiance: 2, color: [1, 0.5, 0] }],
    };
    const request = {
        hair: 'sha256:a',
        environment: 'sha256:b',
        outputs: ['raw'],
        environment_settings: {
            layout: 'latlong',
            rotation_deg: [70, 20, -40],
            exposure_stops: -3,
            tint: [1, 0.5, 0.25],
        },
        irradiance: {
            face_size: 16,
            lights: [{ direction: [0, 1, 0], irradiance: [1, 2, 3] }],
        },
    };
    const { irradiance, environment_settings, ...rest } = compose_request(request, edit);
    assert.deepEqual(rest, { hair: 'sha256:a', environment: 'sha256:b', outputs: ['raw'] });
    assert.equal(irradiance.face_size, 16);
    assert.deepEqual(Object.keys(irradiance).sort(), ['face_size', 'lights']);
    assert.equal(environment_settings.layout, 'latlong');
    assert.equal(environment_settings.exposure_stops, -2);
    assert.deepEqual(environment_settings.tint, [0.5, 0.5, 0.75]);
    const twice = multiply(rotation_matrix(edit.rotation_deg), rotation_matrix([70, 20, -40]));
    assert_near(rotation_matrix(environment_settings.rotation_deg), twice, 1e-10, 'the rotation');
    const v = [0.3, -0.7, 0.2];
    assert_near(
        transform(rotation_matrix(environment_settings.rotation_deg), v),
        reference.turn(reference.turn(v, [70, 20, -40]), edit.rotation_deg),
        1e-10,
        'the old rotation, then the edit',
    );
    const [old, added] = irradiance.lights;
    assert_near(old.direction, reference.turn([0, 1, 0], edit.rotation_deg), 1e-9, 'the old light is turned');
    assert.deepEqual(old.irradiance, [1, 4, 18]); // times 2 times the tint
    assert.deepEqual(added, { direction: [1, 0, 0], irradiance: [2, 1, 0] });
});

test('Without an edit the request stays as it is, to the last digit of its angles', () => {
    const request = {
        environment: 'sha256:b',
        outputs: ['raw'],
        environment_settings: { rotation_deg: [400, 0.1, -190], exposure_stops: 0.3, tint: [1, 2, 3] },
        irradiance: { lights: [{ direction: [3, 4, 0], irradiance: [1, 1, 1] }] },
    };
    assert.deepEqual(compose_request(request, no_edit()), request);
});

test("An edit of an older bake is written to the new places, and the older bake's fields are moved there", () => {
    const old = {
        environment: 'sha256:b',
        irradiance: { exponent: 20, face_size: 8, rotation_deg: [0, 30, 0], exposure_stops: 1, layout: 'latlong' },
    };
    const edit = { ...no_edit(), rotation_deg: [0, 60, 0], exposure_stops: 0.5 };
    assert.deepEqual(compose_request(old, edit), {
        environment: 'sha256:b',
        fiber: { kajiya_kay: { exponent: 20 } },
        environment_settings: { layout: 'latlong', rotation_deg: [0, 90, 0], exposure_stops: 1.5, tint: [1, 1, 1] },
        irradiance: { face_size: 8, lights: [] },
    });
});

test('An edit that no bake would take is refused in words', () => {
    const bright = { environment_settings: { exposure_stops: 60 } };
    assert.throws(
        () => compose_request(bright, { ...no_edit(), exposure_stops: 6 }),
        /66 stops in all; a bake takes -64 to 64/,
    );
    const light = { direction: [0, 1, 0], irradiance: [1, 1, 1] };
    const many = { irradiance: { lights: Array(64).fill(light) } };
    const one_more = { ...no_edit(), lights: [{ azimuth_deg: 0, elevation_deg: 0, irradiance: 1, color: [1, 1, 1] }] };
    assert.throws(() => compose_request(many, one_more), /65 lights in all; a bake takes at most 64/);
});

const horner = (coefficients, x, round = y => y) =>
    coefficients.reduceRight((sum, c) => round(round(sum * x) + round(c)), 0);

test('The polynomial for acos errs by at most 1e-6, and that for the sine by 1e-8', () => {
    let worst = 0,
        worst_single = 0,
        worst_sine = 0;
    for (let i = 0; i <= 200000; i++) {
        const theta = (i / 200000) * (Math.PI / 2),
            q = (2 * Math.sin(theta / 2)) ** 2; // |a - b|^2 at the angle theta
        worst = Math.max(worst, Math.abs(Math.sqrt(q) * horner(angle_polynomial, q) - theta));
        const single = Math.fround(Math.sqrt(Math.fround(q))) * horner(angle_polynomial, Math.fround(q), Math.fround);
        worst_single = Math.max(worst_single, Math.abs(single - theta));
        worst_sine = Math.max(worst_sine, Math.abs(theta * horner(sine_polynomial, theta * theta) - Math.sin(theta)));
    }
    assert.ok(worst < 1e-7 && worst_single < 1e-6, `acos errs by ${worst}, in single precision by ${worst_single}`);
    assert.ok(worst_sine < 1e-8, `the sine errs by ${worst_sine}`);
});

test('The harmonics of a light are those of the associated Legendre recurrence', () => {
    for (let i = 0; i < 200; i++) {
        const v = reference.normalized([random() - 0.5, random() - 0.5, random() - 0.5]);
        assert_near(harmonics(v), reference.harmonics(v), 1e-13, `in the direction ${v}`);
    }
});

test('Every half float survives being read and written, and what lies between goes to the nearest', () => {
    for (let bits = 0; bits < 0x7c00; bits++) {
        assert.equal(to_half(from_half(bits)), bits);
        if (bits) assert.equal(to_half(-from_half(bits)), bits | 0x8000);
        if (bits === 0x7bff) continue;
        const low = from_half(bits),
            step = from_half(bits + 1) - low;
        assert.equal(to_half(low + 0.499 * step), bits);
        assert.equal(to_half(low + 0.501 * step), bits + 1);
        assert.equal(to_half(low + 0.5 * step), bits + (bits & 1)); // of two equally near the even one
    }
    assert.equal(to_half(1e9), 0x7c00);
    assert.equal(to_half(65519), 0x7bff);
});

test('The text of a request names what it does to its environment, from either place of its fields', () => {
    assert.deepEqual(lighting_text({}), []);
    assert.deepEqual(lighting_text({ irradiance: no_edit() }), []);
    const turned = { rotation_deg: [0, -30.04, 0], exposure_stops: -1.5 };
    for (const request of [{ irradiance: turned }, { environment_settings: turned }])
        assert.deepEqual(lighting_text(request), ['sky turned by -30°', '-1.5 stops']);
    const tinted = { rotation_deg: [10, 0, 5], tint: [1, 1, 0.9] };
    for (const request of [
        { irradiance: { ...tinted, lights: [{}] } },
        { environment_settings: tinted, irradiance: { lights: [{}] } },
    ])
        assert.deepEqual(lighting_text(request), ['sky turned by 10° 0° 5° about X Y Z', 'tinted', '1 light added']);
});

const edit = { ...no_edit(), exposure_stops: 1 };
const side = { bake: 0, part: 'diffuse', as_baked: false };

test('A bake that holds the edit is shown as baked beside the one that was edited, and begins a new edit alone', () => {
    const orders = new EditOrders();
    orders.add('new', orders.edit_number, 'old');
    const two = arrange([{ id: 'old' }, { id: 'new' }], side, edit, orders);
    assert.deepEqual(two.sides, [side, { ...side, bake: 1, as_baked: true }]);
    assert.equal(two.edit, edit);
    assert.equal(orders.edit_number, 0);
    const alone = arrange([{ id: 'new' }], { ...side, bake: 1, as_baked: true }, edit, orders);
    assert.deepEqual(alone, { sides: [side], edit: no_edit() });
    assert.equal(orders.edit_number, 1);
    assert.equal(arrange([{ id: 'new' }], side, edit, orders).edit, edit); // an edit of the new bake
});

test('After its edit has ended an ordered bake holds the edit beside the edited bake only', () => {
    const orders = new EditOrders();
    orders.add('new', orders.edit_number, 'old');
    orders.begin_edit();
    const as_baked = left => arrange([{ id: left }, { id: 'new' }], side, edit, orders).sides[1].as_baked;
    assert.deepEqual(['old', 'other'].map(as_baked), [true, false]);
    assert.ok(!orders.holds_edit('other'));
});
