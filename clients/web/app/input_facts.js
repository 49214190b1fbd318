// The service's facts of a hair model or an environment as text.
import { short_digest } from './name_text.js';
import { bytes_text, count_text, number_text } from './number_text.js';

const layout_names = {
    latlong: 'lat-long',
    horizontal_cross: 'horizontal cross',
    vertical_cross: 'vertical cross',
    horizontal_strip: 'horizontal strip',
    vertical_strip: 'vertical strip',
    faces: 'six faces',
};

const vector_text = v => v.map(x => number_text(x, 3)).join(', ');
const range_text = ({ minimum, maximum, default: one }) =>
    minimum === undefined
        ? number_text(one)
        : minimum === maximum
          ? number_text(minimum)
          : `${number_text(minimum)} to ${number_text(maximum)}`;

/** One line below the thumbnail. */
export function summary({ kind, facts, bytes }) {
    const size = bytes_text(bytes);
    if (kind === 'model')
        return `${count_text(facts.strands, 'strand')}, ${count_text(facts.vertices, 'vertex', 'vertices')}, ${size}`;
    const pixels = facts.face_size ? `${facts.face_size} x ${facts.face_size} x 6` : `${facts.width} x ${facts.height}`;
    return `${pixels} ${layout_names[facts.layout] ?? facts.layout}, ${facts.format}, ${size}`;
}

function environment_rows(facts) {
    const bright = facts.brightest_pixel;
    return [
        [
            'Layout',
            `${layout_names[facts.layout] ?? facts.layout}: guessed from the shape unless the bake says otherwise`,
        ],
        ['Primaries', facts.primaries],
        ['Mean radiance', vector_text(facts.mean_radiance)],
        ['Brightest pixel', vector_text(bright.radiance)],
        ['Direction to it', vector_text(bright.direction)],
        ...(facts.small_lights ? [['Sun or small lamps', small_lights_text(facts.small_lights)]] : []),
    ];
}

const small_lights_text = ({ pixels, share }) =>
    `${count_text(pixels, 'pixel holds', 'pixels hold')} ${number_text(100 * share, 2)} % of the light`;

function model_rows(facts) {
    return [
        ['Format', facts.format],
        ['Longest strand', count_text(facts.longest_strand, 'vertex', 'vertices')],
        ...(facts.bounds
            ? [['Bounds', `${vector_text(facts.bounds.minimum)} to ${vector_text(facts.bounds.maximum)}`]]
            : []),
        ['Strand width', range_text(facts.thickness)],
        ['Transparency', range_text(facts.transparency)],
        ...(facts.info ? [['Info text of the file', facts.info]] : []),
    ];
}

/** [term, text] of each fact that the page shows. */
export function fact_rows({ kind, facts, id }) {
    return [...(kind === 'model' ? model_rows(facts) : environment_rows(facts)), ['SHA-256', id]];
}

/** Warnings to read before baking with the input. */
export function warnings({ kind, facts }) {
    const texts = [...(facts.warnings ?? [])];
    if (kind !== 'environment') return texts;
    const { negative = 0, nan = 0, infinite = 0 } = facts.invalid_pixels ?? {};
    if (nan + infinite > 0) texts.push(`${count_text(nan + infinite, 'pixel')} infinite or not a number.`);
    if (negative + nan + infinite > 0) texts.push('A bake refuses such pixels unless its invalid radiance is "clamp".');
    if (facts.low_dynamic_range && !texts.some(text => text.includes('dynamic range')))
        texts.push('Its dynamic range is low: lamps are clipped.');
    if (facts.small_lights) texts.push(`A sun or small lamps: ${small_lights_text(facts.small_lights)}.`);
    return texts;
}

/** The label of an input: its names in the service, else its file name in this browser, else its digest's beginning. */
export function label_of(id, names = {}, files = {}) {
    return names[id]?.join(', ') || files[id] || short_digest(id);
}

/** Names of one kind by digest: { sha256: [path] }. */
export function names_by_digest(list) {
    const names = {};
    for (const { path, sha256 } of list) (names[sha256] ??= []).push(path);
    return names;
}

/** The newest versions of names of one kind: { path: version }. */
export const versions_by_path = list => Object.fromEntries(list.map(({ path, version }) => [path, version]));
