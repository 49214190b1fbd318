// The viewer's linear pixels against the specification, which viewer_reference.mjs evaluates.
//
// The maps have random texels with steep slopes, so the point of a strand in a pixel must be known to about 1e-5 of a
// pixel. Therefore every strand belongs to one view. There it is horizontal, at its own depth, with its vertices on
// centres of pixels: the point is linear in the pixel's column, without rounding. Pixels near strands of other views
// are left out.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { as_half, bake_service, generator, random_maps, strand_files } from './raw_files.mjs';
import { open_browser, open_page, serve, stage } from './support.mjs';
import { Camera, mix, normalized, radiance } from './viewer_reference.mjs';

const width = 400,
    height = 300;
// Relative to the largest value of the picture: a tenth of the error that users are promised. Measured errors are up to
// 4e-5, from single precision (6e-8) of the eye's direction, times 33 maps and texels of slope 4.
const tolerance = 1e-4;
const step = 3; // every third pixel is compared
const views = [
    { azimuth_deg: 0, elevation_deg: 0, distance: 60, target: [0, 0, 0], fov_deg: 30 },
    { azimuth_deg: 115, elevation_deg: 35, distance: 45, target: [1, -2, 0.5], fov_deg: 30 },
    { azimuth_deg: 230, elevation_deg: -50, distance: 80, target: [0, 3, 0], fov_deg: 24 },
    { azimuth_deg: 300, elevation_deg: 90, distance: 50, target: [-1, 0, 2], fov_deg: 40 },
];
const look = { albedo: 0.7, color: [0.8, 0.5, 0.25], specular: 0.3 };
const unedited = { rotation_deg: [0, 0, 0], exposure_stops: 0, tint: [1, 1, 1], lights: [] };
const edited = {
    rotation_deg: [20, -130, 75],
    exposure_stops: 1.3,
    tint: [0.9, 1.2, 0.4],
    lights: Array.from({ length: 8 }, (_, i) => ({
        azimuth_deg: 47 * i - 160,
        elevation_deg: 80 - 23 * i,
        irradiance: 1 + 0.4 * i,
        color: [1, 1 - 0.1 * i, 0.1 * i],
    })),
};
const whole = { bake: 0, part: 'all', with_transmittance: true, hidden_by: 'average' };

// --- the hair --------------------------------------------------------------------------------------------------------

function unit_vector(random) {
    const v = [random() - 0.5, random() - 0.5, random() - 0.5];
    return normalized(v).map(x => as_half(x).value);
}

function random_vertex(random, position, previous) {
    const coefficients = Array.from(
        { length: 16 },
        (_, i) => as_half(i ? 0.9 * (random() - 0.5) : 1.7 * random()).value,
    );
    let tangent = unit_vector(random);
    if (
        previous &&
        tangent[0] * previous.tangent[0] + tangent[1] * previous.tangent[1] + tangent[2] * previous.tangent[2] < 0
    )
        tangent = tangent.map(x => -x);
    return {
        position: position.map(Math.fround),
        tangent,
        average: as_half(random()).value,
        sh: coefficients,
        cone: [...unit_vector(random), as_half(3.14 * random()).value],
    };
}

/**
 * Strands of three vertices, a row of pixels each: {vertices, begin, rows}; rows know their view, columns and vertices.
 */
function random_hair(random) {
    const vertices = [],
        begin = [0],
        rows = [];
    views.forEach((view, k) => {
        const camera = new Camera(view, width, height);
        for (let y = 5; y < height - 5; y += 9) {
            const depth = view.distance * (0.9 + 0.2 * random()),
                first = 3 + Math.floor(120 * random());
            const columns = [first, first + 60 + Math.floor(60 * random()), width - 4 - Math.floor(100 * random())];
            const place = columns.map(x => camera.point([x + 0.5, y + 0.5], depth));
            const start = vertices.length;
            place.forEach((position, i) =>
                vertices.push(random_vertex(random, position, i ? vertices[start + i - 1] : null)),
            );
            begin.push(vertices.length);
            rows.push({ k, y, columns, start });
        }
    });
    return { vertices, begin, rows };
}

/** The interpolated point between two vertices, seen from the eye. */
function point_between(a, b, s, camera) {
    const moment = v => v.cone.slice(0, 3).map(x => x * v.average * 0.5 * (1 + Math.cos(v.cone[3])));
    const place = mix(a.position, b.position, s);
    return {
        tangent: normalized(mix(a.tangent, b.tangent, s)),
        to_eye: normalized(camera.eye.map((x, i) => x - place[i])),
        average: a.average + s * (b.average - a.average),
        sh: mix(a.sh, b.sh, s),
        moment: mix(moment(a), moment(b), s),
    };
}

function distance_to_segment([x, y], [[ax, ay], [bx, by]]) {
    const dx = bx - ax,
        dy = by - ay;
    const s = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0), 1);
    return Math.hypot(x - ax - s * dx, y - ay - s * dy);
}

/** The pixels of view k that show a point of its own rows: {x, y, point}. */
function visible_points({ vertices, rows }, k) {
    const camera = new Camera(views[k], width, height),
        points = [];
    const others = rows
        .filter(row => row.k !== k)
        .map(({ start }) => [0, 2].map(i => camera.pixel(vertices[start + i].position)));
    for (const { y, columns, start } of rows.filter(row => row.k === k))
        for (let x = columns[0] + 1; x < columns[2]; x += step) {
            const i = x < columns[1] ? 0 : 1,
                s = (x - columns[i]) / (columns[i + 1] - columns[i]);
            if (x === columns[1] || others.some(segment => distance_to_segment([x + 0.5, y + 0.5], segment) < 2))
                continue;
            points.push({ x, y, point: point_between(vertices[start + i], vertices[start + i + 1], s, camera) });
        }
    return points;
}

// --- the viewer ------------------------------------------------------------------------------------------------------

let site, server, browser, page, hair, scenes;

before(async () => {
    const random = generator(20260722);
    hair = random_hair(random);
    const strands = strand_files(hair.vertices, hair.begin);
    const fine = random_maps(random, 8, 34, { scale: 1, exponent: 64 }),
        coarse = random_maps(random, 5, 10, { scale: 4, exponent: 17 });
    scenes = [
        { maps: fine.maps, scale: 1, exponent: 64, look },
        { maps: coarse.maps, scale: 4, exponent: 17, look },
    ];
    site = stage();
    server = await serve(
        site.folder,
        bake_service({
            fine: { files: { ...strands, ...fine.files } },
            coarse: { files: { ...strands, ...coarse.files } },
        }),
    );
    browser = await open_browser();
    page = await open_page(browser);
    await page.goto(`${server.origin}/viewer/viewer.css`);
    await page.evaluate(load_view, { look });
});
after(async () => {
    await browser?.close();
    await server?.close();
    site?.remove();
});

async function load_view({ look }) {
    const { load_bake } = await import('/viewer/bake_files.js');
    const { HairView } = await import('/viewer/hair_view.js');
    const api = {
        ask: (path, options) => fetch(path, options),
        json: async path => (await fetch(path)).json(),
        file_url: (id, name) => `/v1/bakes/${id}/files/${name}`,
    };
    const view = new HairView(document.createElement('canvas'), { antialias: false });
    view.set_bakes([await load_bake(api, 'fine'), await load_bake(api, 'coarse')]);
    view.set_look(look);
    window.view = view;
}

/** RGBA of the pixels [x, y] of a picture. */
function pixels_of(camera, edit, sides, places) {
    return page.evaluate(
        ({ camera, edit, sides, places, width, height }) => {
            Object.assign(window.view.camera, camera);
            window.view.set_lighting(edit);
            window.view.set_sides(sides);
            const pixels = window.view.linear_pixels(width, height);
            return places.map(([x, y]) => [...pixels.slice(4 * (y * width + x), 4 * (y * width + x) + 4)]);
        },
        { camera, edit, sides, places, width: width * sides.length, height },
    );
}

function lights_of({ lights }) {
    const radians = Math.PI / 180;
    return lights.map(({ azimuth_deg, elevation_deg, irradiance, color }) => ({
        direction: [
            Math.cos(elevation_deg * radians) * Math.sin(azimuth_deg * radians),
            Math.sin(elevation_deg * radians),
            Math.cos(elevation_deg * radians) * Math.cos(azimuth_deg * radians),
        ],
        irradiance: color.map(c => c * irradiance),
    }));
}

/** The picture of view k with these sides, next to each other, equals the specification. */
async function compare(k, edit, sides) {
    const points = visible_points(hair, k);
    assert.ok(points.length > 1000, `only ${points.length} pixels to compare`);
    const places = sides.flatMap((_, i) => points.map(({ x, y }) => [x + i * width, y]));
    const found = await pixels_of(views[k], edit, sides, places);
    const expected = sides.flatMap(side => {
        const scene = { ...scenes[side.bake], edit: { ...edit, lights: lights_of(edit) } };
        return points.map(({ point }) => radiance(point, scene, side));
    });
    const largest = Math.max(...expected.flat());
    let worst = 0,
        where;
    found.forEach(([...rgba], i) => {
        assert.equal(rgba[3], 1, `no hair at ${places[i]}`);
        for (let c = 0; c < 3; c++) {
            const error = Math.abs(rgba[c] - expected[i][c]) / largest;
            if (!(error <= worst)) [worst, where] = [error, places[i]];
        }
    });
    assert.ok(worst <= tolerance, `view ${k}: off by ${worst} of the largest value at pixel ${where}`);
    return { pixels: found.length, worst };
}

const cases = {
    'A (Kd D + Ks S) of the bake as it is': [unedited, [whole]],
    'the diffuse part alone': [unedited, [{ ...whole, part: 'diffuse' }]],
    'the specular part alone': [unedited, [{ ...whole, part: 'specular' }]],
    'A alone': [unedited, [{ ...whole, part: 'transmittance' }]],
    'everything but A': [edited, [{ ...whole, with_transmittance: false }]],
    'a sky turned, exposed and tinted, and eight lights times A': [edited, [whole]],
    'eight lights times the directional transmittance': [edited, [{ ...whole, hidden_by: 'harmonics' }]],
    'eight lights within the bent cones': [edited, [{ ...whole, hidden_by: 'cone' }]],
    'two bakes of 33 and 9 maps side by side': [edited, [whole, { ...whole, bake: 1 }]],
    'one bake with and without A side by side': [unedited, [whole, { ...whole, with_transmittance: false }]],
};

for (const [what, [edit, sides]] of Object.entries(cases))
    test(`The viewer's pixels are ${what}, from four views`, async t => {
        for (const k of views.keys()) {
            const { pixels, worst } = await compare(k, edit, sides);
            t.diagnostic(`view ${k}: ${pixels} pixels, off by at most ${worst.toExponential(1)} of the largest value`);
        }
    });

test("Nothing was written to the browser's console", () => {
    assert.deepEqual(page.problems, []);
});
