// The service's facts of a hair model or an environment as lines for people.
import { bytes_words, count_words, number_words, short_digest } from './words.js';

const layout_words = {
    latlong: 'lat-long',
    horizontal_cross: 'horizontal cross',
    vertical_cross: 'vertical cross',
    horizontal_strip: 'horizontal strip',
    vertical_strip: 'vertical strip',
    faces: 'six faces',
};

const vector_words = v => v.map(x => number_words(x, 3)).join(', ');
const range_words = ({ minimum, maximum, default: one }) =>
    minimum === undefined
        ? number_words(one)
        : minimum === maximum
          ? number_words(minimum)
          : `${number_words(minimum)} to ${number_words(maximum)}`;

/** One line below the thumbnail. */
export function summary({ kind, facts, bytes }) {
    const size = bytes_words(bytes);
    if (kind === 'model')
        return `${count_words(facts.strands, 'strand')}, ${count_words(facts.vertices, 'vertex', 'vertices')}, ${size}`;
    const pixels = facts.face_size ? `${facts.face_size} x ${facts.face_size} x 6` : `${facts.width} x ${facts.height}`;
    return `${pixels} ${layout_words[facts.layout] ?? facts.layout}, ${facts.format}, ${size}`;
}

function environment_rows(facts) {
    const bright = facts.brightest_pixel;
    return [
        [
            'Layout',
            `${layout_words[facts.layout] ?? facts.layout}: guessed from the shape unless the bake says otherwise`,
        ],
        ['Primaries', facts.primaries],
        ['Mean radiance', vector_words(facts.mean_radiance)],
        ['Brightest pixel', vector_words(bright.radiance)],
        ['Direction to it', vector_words(bright.direction)],
        ...(facts.small_lights ? [['Sun or small lamps', lights_words(facts.small_lights)]] : []),
    ];
}

const lights_words = ({ pixels, share }) =>
    `${count_words(pixels, 'pixel holds', 'pixels hold')} ${number_words(100 * share, 2)} % of the light`;

function model_rows(facts) {
    return [
        ['Format', facts.format],
        ['Longest strand', count_words(facts.longest_strand, 'vertex', 'vertices')],
        ...(facts.bounds
            ? [['Bounds', `${vector_words(facts.bounds.minimum)} to ${vector_words(facts.bounds.maximum)}`]]
            : []),
        ['Strand width', range_words(facts.thickness)],
        ['Transparency', range_words(facts.transparency)],
        ...(facts.info ? [['Its own words', facts.info]] : []),
    ];
}

/** [term, text] of everything that is worth reading. */
export function fact_rows({ kind, facts, id }) {
    return [...(kind === 'model' ? model_rows(facts) : environment_rows(facts)), ['SHA-256', id]];
}

/** What a person should know before baking with it. */
export function warnings({ kind, facts }) {
    const texts = [...(facts.warnings ?? [])];
    if (kind !== 'environment') return texts;
    const { negative = 0, nan = 0, infinite = 0 } = facts.invalid_pixels ?? {};
    if (nan + infinite > 0) texts.push(`${count_words(nan + infinite, 'pixel')} infinite or not a number.`);
    if (negative + nan + infinite > 0) texts.push('A bake refuses such pixels unless its invalid radiance is "clamp".');
    if (facts.low_dynamic_range && !texts.some(text => text.includes('dynamic range')))
        texts.push('Its dynamic range is low: lamps are clipped.');
    if (facts.small_lights) texts.push(`A sun or small lamps: ${lights_words(facts.small_lights)}.`);
    return texts;
}

/** What people call an input: its names in the service, the file name that it had here, or the digest's beginning. */
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
