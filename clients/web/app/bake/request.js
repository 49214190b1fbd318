// A form's values and the request that they make.
import { defaults_of, fields_of } from './schema.js';

export const value_at = (values, path) => path.reduce((part, name) => part?.[name], values);

/** A copy of `values` with another value at `path`. */
export function with_value(values, path, value) {
    if (path.length === 0) return value;
    const [name, ...rest] = path;
    return { ...values, [name]: with_value(values?.[name] ?? {}, rest, value) };
}

const is_block = value => typeof value === 'object' && value !== null && !Array.isArray(value);

/** `values` with the fields that `request` gives. */
export function merged(values, request) {
    const result = { ...values };
    for (const [name, value] of Object.entries(request))
        result[name] = is_block(value) && is_block(values[name]) ? merged(values[name], value) : structuredClone(value);
    return result;
}

// What the page itself shows maps, histogram and viewer from.
const for_this_page = ['raw'];

/** The form's values at its beginning: the defaults, with the output that this page needs. */
export function first_values(schema) {
    const values = defaults_of(schema);
    return { ...values, outputs: [...new Set([...values.outputs, ...for_this_page])] };
}

/** The request with only those fields that differ from the schema's defaults; outputs and files are always named. */
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
 * The names of an input as a request calls them; names: { sha256: [path] }, versions: { path: version }. They hold the
 * version, as a name that has moved since the page asked means another file than the one that is shown; the bake
 * follows the name all the same.
 */
export const names_of = (id, { names, versions }) => (names[id] ?? []).map(path => `name:${path}@${versions[path]}`);

/**
 * What a request calls an input: chosen is { id: digest or '', by: one of names_of, '' for the file itself, or
 * undefined for its first name where it has one }; inputs: what names_of takes.
 */
export function reference_to({ id, by }, inputs) {
    if (!id) return null;
    const known = names_of(id, inputs);
    if (by === '' || known.length === 0) return `sha256:${id}`;
    return known.includes(by) ? by : known[0];
}
