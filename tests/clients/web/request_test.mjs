// The page's requests in node: what the form makes of the schema, and what it writes again from older requests.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { request_by_names } from '../../../clients/web/app/bake/by_names.js';
import {
    early_faults,
    fault_of,
    faults_of_form,
    faults_of_problem,
} from '../../../clients/web/app/bake/form_faults.js';
import {
    build_request,
    differences,
    first_values,
    merged,
    names_of,
    reference_to,
    with_value,
} from '../../../clients/web/app/bake/request.js';
import { environment_settings_of, in_new_places } from '../../../clients/web/app/bake/request_fields.js';
import { block_names, defaults_of, faults, fields_of, range_text } from '../../../clients/web/app/bake/schema.js';
import { names_by_digest, versions_by_path } from '../../../clients/web/app/input_facts.js';

const config = new URL('../../../config/', import.meta.url);
const schema = JSON.parse(readFileSync(new URL('request.schema.json', config)));

/** A schema of a few fields as the service's: at the top, in a block, in a block of a block. */
const number = { type: 'number', minimum: 0, maximum: 4096, default: 64 };
const block = properties => ({ type: 'object', additionalProperties: false, properties });
const nested_schema = block({
    hair: { type: ['string', 'null'], default: null },
    environment: { type: ['string', 'null'], default: null },
    fiber: block({
        model: { enum: ['kajiya-kay'], default: 'kajiya-kay' },
        kajiya_kay: block({ exponent: number }),
    }),
    environment_settings: block({
        tint: { type: 'array', minItems: 3, maxItems: 3, items: { ...number, maximum: 1e6 }, default: [1, 1, 1] },
    }),
    irradiance: block({
        face_size: { ...number, type: 'integer', default: 16 },
        exponent: { description: 'Deprecated: now fiber.kajiya_kay.exponent.', deprecated: true },
    }),
    outputs: { type: 'array', uniqueItems: true, items: { enum: ['npy', 'raw'] }, default: ['npy'] },
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
    const values = with_value(base, ['irradiance', 'sh_error'], 0.02);
    assert.deepEqual(build_request(schema, values), {
        transmittance: { directions: 32, reference_vertices: 64 },
        irradiance: { face_size: 8, specular_maps: 17, sh_error: 0.02 },
        outputs: ['npy', 'exr', 'hair', 'raw'],
    });
    assert.deepEqual(differences(schema, values, base), ['irradiance.sh_error']);
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
    const tint_faults = tint =>
        faults(nested_schema, { environment_settings: { tint } }).map(({ path, message }) => `${path} ${message}`);
    assert.deepEqual(tint_faults([1, 2, -1]), ['environment_settings.tint.2 is -1; allowed is 0 to 1000000']);
    assert.deepEqual(tint_faults([1]), ['environment_settings.tint has 1 entries; allowed are 3 to 3']);
    assert.deepEqual(wrong({ irradiance: { lights: [{ direction: [0, 1, 0] }] } }), [
        'irradiance.lights.0.irradiance is missing',
    ]);
    assert.deepEqual(wrong({ outputs: ['npy', 'npy'] }), ['outputs has an entry twice']);
    assert.deepEqual(wrong({ colour: 1, toString: 2 }), ['colour is not a field', 'toString is not a field']);
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

test('blocks within blocks are fields of the form as others are', () => {
    assert.deepEqual(block_names(nested_schema), ['fiber', 'environment_settings', 'irradiance']);
    assert.deepEqual(
        fields_of(nested_schema).map(({ path }) => path.join('.')),
        [
            'hair',
            'environment',
            'fiber.model',
            'fiber.kajiya_kay.exponent',
            'environment_settings.tint',
            'irradiance.face_size', // not the deprecated exponent
            'outputs',
        ],
    );
    const start = first_values(nested_schema);
    assert.deepEqual(start.fiber, { model: 'kajiya-kay', kajiya_kay: { exponent: 64 } });
    assert.deepEqual(start.irradiance, { face_size: 16 });
    const values = with_value(start, ['fiber', 'kajiya_kay', 'exponent'], 20);
    assert.deepEqual(differences(nested_schema, values, start), ['fiber.kajiya_kay.exponent']);
    assert.deepEqual(build_request(nested_schema, values), {
        fiber: { kajiya_kay: { exponent: 20 } },
        outputs: ['npy', 'raw'],
    });
    const preset = { fiber: { kajiya_kay: { exponent: 8 } } };
    assert.deepEqual(merged(start, preset).fiber, { model: 'kajiya-kay', kajiya_kay: { exponent: 8 } });
    const wrong = faults(nested_schema, { fiber: { kajiya_kay: { exponent: -1, p: 1 } } });
    assert.deepEqual(wrong, [
        { path: 'fiber.kajiya_kay.exponent', message: 'is -1; allowed is 0 to 4096' },
        { path: 'fiber.kajiya_kay.p', message: 'is not a field' },
    ]);
});

test('faults of the form are found by field, those of the service too', () => {
    const request = { fiber: { kajiya_kay: { exponent: -1 } }, environment_settings: { tint: [1, 2, -1] } };
    const waits = { occluder: 'head.obj is still being sent.', receiver: null };
    const wrong = faults_of_form(nested_schema, request, waits);
    assert.deepEqual(Object.keys(wrong).sort(), [
        'environment_settings.tint.2',
        'fiber.kajiya_kay.exponent',
        'hair',
        'occluder',
    ]);
    assert.equal(fault_of(wrong, ['fiber', 'kajiya_kay', 'exponent']).place, '');
    assert.equal(fault_of(wrong, ['environment_settings', 'tint']).place, '2');
    assert.equal(fault_of(wrong, ['environment']), undefined); // not that of environment_settings
    const early = Object.keys(early_faults(wrong, waits));
    assert.deepEqual(early.sort(), ['environment_settings.tint.2', 'fiber.kajiya_kay.exponent']);
    const refusal = { field: 'irradiance.lights[1].direction', message: 'is 0' };
    assert.deepEqual(faults_of_problem(refusal), { 'irradiance.lights.1.direction': 'is 0' });
    assert.deepEqual(faults_of_problem({ message: 'no field' }), {});
    assert.deepEqual(faults_of_problem(null), {});
});

const old_irradiance = {
    model: 'kajiya-kay',
    exponent: 20,
    layout: 'latlong',
    latlong: 'openexr',
    rotation_deg: [0, 90, 0],
    exposure_stops: -1,
    tint: [1, 0.5, 0.25],
    invalid_radiance: 'clamp',
};

test("an older request's fields are moved to their new places, and none stays behind", () => {
    const { model, exponent, ...environment_settings } = old_irradiance;
    const fiber = { model, kajiya_kay: { exponent } };
    const old = { hair: 'sha256:a', irradiance: { ...old_irradiance, face_size: 8 }, outputs: ['raw'] };
    const moved = { hair: 'sha256:a', fiber, environment_settings, irradiance: { face_size: 8 }, outputs: ['raw'] };
    assert.deepEqual(in_new_places(old), moved);
    assert.deepEqual(in_new_places(moved), moved);
    assert.deepEqual(in_new_places({ irradiance: old_irradiance }), { fiber, environment_settings });
    assert.deepEqual(in_new_places({ irradiance: {} }), { irradiance: {} });
    assert.deepEqual(in_new_places({}), {});
    assert.deepEqual(environment_settings_of(old), environment_settings);
    assert.deepEqual(environment_settings_of(moved), environment_settings);
    assert.deepEqual(environment_settings_of({ hair: 'sha256:a' }), {});
    assert.equal(old.irradiance.exponent, 20); // the old request is left as it was
});

test('where a request holds a field in both places, the new place wins', () => {
    const both = {
        fiber: { kajiya_kay: { exponent: 10 } },
        environment_settings: { exposure_stops: 2 },
        irradiance: { exponent: 20, exposure_stops: 1, rotation_deg: [0, 5, 0] },
    };
    assert.deepEqual(in_new_places(both), {
        fiber: { kajiya_kay: { exponent: 10 } },
        environment_settings: { exposure_stops: 2, rotation_deg: [0, 5, 0] },
    });
});

test('the request of an older bake is written again with its names and the new places', () => {
    const request = { hair: 'sha256:a', irradiance: { exponent: 20, face_size: 8 }, outputs: ['raw'] };
    assert.deepEqual(request_by_names({ request, names: { hair: { path: 'heads/curly', version: 3 } } }), {
        hair: 'name:heads/curly@3',
        fiber: { kajiya_kay: { exponent: 20 } },
        irradiance: { face_size: 8 },
        outputs: ['raw'],
    });
});

test('a preset in the old places sets the fields in the new ones', () => {
    const start = first_values(schema);
    const preset = { irradiance: { ...old_irradiance, face_size: 8 } };
    const request = build_request(schema, merged(start, in_new_places(preset)));
    const { model, exponent, ...environment_settings } = old_irradiance; // the model is the default
    assert.deepEqual(request, {
        fiber: { kajiya_kay: { exponent } },
        environment_settings,
        irradiance: { face_size: 8 },
        outputs: ['npy', 'exr', 'hair', 'raw'],
    });
});
