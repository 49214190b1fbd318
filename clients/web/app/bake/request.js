// The values of the form, and the request made of them.
import { defaults_of, fields_of } from './schema.js';

export const value_at = (values, path) => path.reduce((part, name) => part?.[name], values);

/** A copy of `values` with another value at `path`. */
export function with_value(values, path, value) {
    if (path.length === 0) return value;
    const [name, ...rest] = path;
    return { ...values, [name]: with_value(values?.[name] ?? {}, rest, value) };
}

const is_block = value => typeof value === 'object' && value !== null && !Array.isArray(value);

/** A copy of `values`, with the values of those fields that `request` has. */
export function merged(values, request) {
    const result = { ...values };
    for (const [name, value] of Object.entries(request))
        result[name] = is_block(value) && is_block(values[name]) ? merged(values[name], value) : structuredClone(value);
    return result;
}

// The output that maps, histogram and viewer of the page read.
const for_this_page = ['raw'];

/** The first values of the form: the defaults, and the output that the page reads. */
export function first_values(schema) {
    const values = defaults_of(schema);
    return { ...values, outputs: [...new Set([...values.outputs, ...for_this_page])] };
}

/** The request of the fields that differ from the schema's defaults, and of the outputs. */
export function build_request(schema, values) {
    const defaults = defaults_of(schema);
    let request = {};
    for (const { path } of fields_of(schema)) {
        const value = value_at(values, path);
        const always = path[0] === 'outputs';
        if (always || JSON.stringify(value) !== JSON.stringify(value_at(defaults, path)))
            request = with_value(request, path, value);
    }
    return request;
}

/** The fields, by dotted path, in which two values differ. */
export function differences(schema, a, b) {
    return fields_of(schema)
        .map(({ path }) => path)
        .filter(path => JSON.stringify(value_at(a, path)) !== JSON.stringify(value_at(b, path)))
        .map(path => path.join('.'));
}

/**
 * The references to an input by its names: ["name:PATH@VERSION"]. They hold the version, because a name may point at
 * another file by the time of the request. A bake with such a reference still follows the name.
 * names: { sha256: [path] }; versions: { path: version }.
 */
export const names_of = (id, { names, versions }) => (names[id] ?? []).map(path => `name:${path}@${versions[path]}`);

/**
 * The request's reference to an input, or null without one.
 * id: digest of the file or ''; by: one of names_of, '' for the digest, undefined for the first name if there is one;
 * inputs: { names, versions } of names_of.
 */
export function reference_to({ id, by }, inputs) {
    if (!id) return null;
    const known = names_of(id, inputs);
    if (by === '' || known.length === 0) return `sha256:${id}`;
    return known.includes(by) ? by : known[0];
}
