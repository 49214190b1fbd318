// Memory of the viewer on the graphics card, also with a model of the largest published size.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { as_half, bake_service, generator, random_maps, strand_files } from './raw_files.mjs';
import { open_browser, open_page, serve, stage } from './support.mjs';

const strand_count = 50000,
    points = 30; // 1.5 million vertices

/**
 * Straight strands that hang from a square: arrays written directly, since objects of 1.5 M vertices take a gigabyte.
 */
function large_files(random) {
    const vertices = strand_count * points,
        positions = new Float32Array(3 * vertices),
        halves = new Uint16Array(4 * vertices);
    const [zero, down, share] = [0, -1, 0.5].map(x => as_half(x).bits);
    for (let s = 0; s < strand_count; s++) {
        const x = 10 * random() - 5,
            z = 10 * random() - 5;
        for (let i = 0; i < points; i++) {
            const v = s * points + i;
            positions.set([x, -i / 3, z], 3 * v);
            halves.set([zero, down, zero, share], 4 * v);
        }
    }
    const begin = Uint32Array.from({ length: strand_count + 1 }, (_, s) => s * points);
    const arrays = [],
        pieces = [];
    let offset = 0;
    for (const [name, array] of Object.entries({ positions, tangent_and_transmittance: halves, strand_begin: begin })) {
        arrays.push({ name, offset, bytes: array.byteLength });
        pieces.push(Buffer.from(array.buffer));
        offset += array.byteLength;
    }
    const page = {
        content: 'hairbake strands',
        vertices,
        strands: strand_count,
        bounds: [
            [-5, -10, -5],
            [5, 0, 5],
        ],
        sh_bands: 0,
        arrays,
    };
    return { 'strands.json': JSON.stringify(page), 'strands.bin': Buffer.concat(pieces) };
}

function small_files(random) {
    const vertex = () => ({
        position: [random(), random(), random()],
        tangent: [0, 1, 0],
        average: 0.5,
        sh: [1, 0, 0, 0],
        cone: [0, 1, 0, 1],
    });
    return strand_files(
        Array.from({ length: 100 }, vertex),
        Array.from({ length: 11 }, (_, s) => 10 * s),
    );
}

let site, server, browser, page;

before(async () => {
    const random = generator(3);
    const maps = () => random_maps(random, 8, 34, { scale: 1, exponent: 64 }).files;
    const shared = small_files(random);
    site = stage();
    server = await serve(
        site.folder,
        bake_service({
            one: { files: { ...shared, ...maps() } },
            two: { files: { ...small_files(random), ...maps() } },
            large: { files: { ...large_files(random), ...maps() } },
        }),
    );
    browser = await open_browser();
    page = await open_page(browser);
    await page.goto(`${server.origin}/viewer/viewer.css`);
    await page.evaluate(async () => {
        const { load_bake } = await import('/viewer/bake_files.js');
        const { HairView } = await import('/viewer/hair_view.js');
        const api = {
            ask: (path, options) => fetch(path, options),
            json: async path => (await fetch(path)).json(),
            file_url: (id, name) => `/v1/bakes/${id}/files/${name}`,
        };
        window.load = (id, known = []) => load_bake(api, id, { known });
        window.view = new HairView(document.createElement('canvas'), { antialias: false });
        window.view.resize(640, 480);
    });
});
after(async () => {
    await browser?.close();
    await server?.close();
    site?.remove();
});

test('A bake takes one geometry and one texture, and another model frees those of the first', async () => {
    const found = await page.evaluate(async () => {
        const { load, view } = window,
            memory = [];
        const show = bakes => {
            view.set_bakes(bakes);
            view.set_sides(
                bakes.map((_, i) => ({ bake: i, part: 'all', with_transmittance: true, hidden_by: 'average' })),
            );
            view.draw();
            memory.push(view.memory());
        };
        const one = await load('one'),
            two = await load('two');
        show([one]);
        show([one, two]);
        show([two]);
        show([]);
        return memory;
    });
    assert.deepEqual(found, [
        { geometries: 1, textures: 1 },
        { geometries: 2, textures: 2 },
        { geometries: 1, textures: 1 },
        { geometries: 0, textures: 0 },
    ]);
});

test('A bake that is already there is not fetched again, and its arrays have left main memory', async () => {
    const requests = [];
    page.on('request', request => requests.push(new URL(request.url()).pathname));
    const kept = await page.evaluate(async () => {
        const { load, view } = window,
            bake = await load('one');
        view.set_bakes([bake]);
        view.draw();
        const again = await load('one', [bake]);
        const arrays = Object.values({ ...bake.strands, ...bake.maps }).filter(value => ArrayBuffer.isView(value));
        view.set_bakes([]);
        return { same: again.strands === bake.strands && again.maps === bake.maps, arrays: arrays.length };
    });
    assert.deepEqual(kept, { same: true, arrays: 0 });
    const bulk = requests.filter(path => /strands\.bin|maps\.f16/.test(path));
    assert.deepEqual(
        bulk.map(path => path.split('/').pop()),
        ['strands.bin', 'maps.f16'],
    );
});

test('1.5 million vertices are loaded and drawn, and their memory is freed', async t => {
    const { milliseconds, covered, during, after_all } = await page.evaluate(async () => {
        const { load, view } = window;
        view.set_bakes([await load('large')]);
        view.frame_hair();
        const begin = performance.now();
        view.draw();
        const milliseconds = performance.now() - begin,
            pixels = view.linear_pixels(320, 240);
        const during = view.memory();
        view.set_bakes([]);
        const lit = pixels.filter((value, i) => i % 4 === 1 && value > 0 && pixels[i + 2] === 1).length;
        return { milliseconds, covered: lit, during, after_all: view.memory() };
    });
    t.diagnostic(`${Math.round(milliseconds)} ms for the first frame at 640 x 480, in software`);
    // The box stands 10 high and 10 wide in a picture of 4:3 with a margin: nearly half of its 76,800 pixels, all lit.
    assert.ok(covered > 25000, `only ${covered} pixels show lit hair`);
    assert.deepEqual(during, { geometries: 1, textures: 1 });
    assert.deepEqual(after_all, { geometries: 0, textures: 0 });
});

test("Nothing was written to the browser's console", () => {
    assert.deepEqual(page.problems, []);
});
