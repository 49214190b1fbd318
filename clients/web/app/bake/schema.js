// The request's JSON schema: its fields, defaults and ranges, and validation of a value. It supports the part of JSON
// Schema that config/request.schema.json uses.
import { number_text } from '../number_text.js';

/** [name, schema] of the parts of a block; deprecated ones are left out, as the form neither shows nor writes them. */
const parts_of = schema => Object.entries(schema.properties).filter(([, part]) => !part.deprecated);

/** { path: ['irradiance', 'face_size'], schema } of every field in `schema`, also in blocks within blocks. */
export function fields_of(schema, path = []) {
    return parts_of(schema).flatMap(([name, part]) =>
        part.properties ? fields_of(part, [...path, name]) : [{ path: [...path, name], schema: part }],
    );
}

/** Names of the blocks at the top of the schema. */
export const block_names = schema =>
    parts_of(schema)
        .filter(([, part]) => part.properties)
        .map(([name]) => name);

/** Every field's default, as a request. */
export function defaults_of(schema) {
    return Object.fromEntries(
        parts_of(schema).map(([name, part]) => [
            name,
            part.properties ? defaults_of(part) : structuredClone(part.default ?? null),
        ]),
    );
}

const types_of = schema => [schema.type ?? []].flat();

/** The alternative of the schema that allows numbers, or null. */
export function number_part(schema) {
    if (types_of(schema).some(type => type === 'number' || type === 'integer')) return schema;
    return (schema.anyOf ?? []).find(part => number_part(part)) ?? null;
}

export const takes_null = schema => types_of(schema).includes('null');
/** The word that is allowed instead of a number, such as "auto", or undefined. */
export const word_of = schema => (schema.anyOf ?? []).find(part => 'const' in part)?.const;

/** "16 to 4096", "more than 0, up to 1", "one of a, b". */
export function range_text(schema) {
    if (schema.enum) return `one of ${schema.enum.join(', ')}`;
    const part = number_part(schema);
    if (part) {
        const low =
            part.exclusiveMinimum !== undefined
                ? `more than ${range_number(part.exclusiveMinimum)}, up to`
                : `${range_number(part.minimum)} to`;
        const word = word_of(schema);
        const whole = part.type === 'integer' ? ', whole' : '';
        return `${low} ${range_number(part.maximum)}${whole}${word ? `, or ${word}` : ''}`;
    }
    if (schema.type === 'array' && number_part(schema.items ?? {}))
        return `${schema.minItems} numbers, each ${range_text(schema.items)}`;
    return '';
}

// Limits are not rounded: 9007199254740991 keeps its digits.
function range_number(value) {
    if (Math.abs(value) >= 1e16) return value.toExponential().replace('+', '');
    return Number.isInteger(value) ? String(value) : number_text(value);
}

function type_fits(type, value) {
    if (type === 'null') return value === null;
    if (type === 'integer') return Number.isInteger(value);
    if (type === 'number') return typeof value === 'number' && Number.isFinite(value);
    if (type === 'array') return Array.isArray(value);
    if (type === 'object') return typeof value === 'object' && value !== null && !Array.isArray(value);
    return typeof value === type;
}

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

function number_fits(schema, value) {
    return (
        !(value < schema.minimum) &&
        !(value > schema.maximum) &&
        !(value <= schema.exclusiveMinimum) &&
        !(value >= schema.exclusiveMaximum)
    );
}

function as_text(value) {
    return value === null ? 'empty' : JSON.stringify(value);
}

/** Where a value breaks the schema: [{ path: 'irradiance.face_size', message }]. */
export function faults(schema, value, path = '') {
    const wrong = message => [{ path, message }];
    const types = types_of(schema);
    if (types.length && !types.some(type => type_fits(type, value)))
        return wrong(`is ${as_text(value)}; allowed is ${range_text(schema) || types.join(' or ')}`);
    if (schema.enum && !schema.enum.some(one => same(one, value)))
        return wrong(`is ${as_text(value)}; allowed is ${range_text(schema)}`);
    if ('const' in schema && !same(schema.const, value))
        return wrong(`is ${as_text(value)}; allowed is ${schema.const}`);
    if (schema.anyOf && !schema.anyOf.some(part => faults(part, value).length === 0))
        return wrong(`is ${as_text(value)}; allowed is ${range_text(schema)}`);
    if (typeof value === 'number' && !number_fits(schema, value))
        return wrong(`is ${value}; allowed is ${range_text(schema)}`);
    if (typeof value === 'string' && value.length < (schema.minLength ?? 0)) return wrong('is empty');
    if (Array.isArray(value)) return array_faults(schema, value, path);
    if (schema.properties && value !== null && typeof value === 'object') return object_faults(schema, value, path);
    return [];
}

function array_faults(schema, value, path) {
    const { minItems = 0, maxItems = Infinity } = schema;
    if (value.length < minItems || value.length > maxItems)
        return [{ path, message: `has ${value.length} entries; allowed are ${minItems} to ${maxItems}` }];
    if (schema.uniqueItems && new Set(value.map(item => JSON.stringify(item))).size < value.length)
        return [{ path, message: 'has an entry twice' }];
    return schema.items ? value.flatMap((item, i) => faults(schema.items, item, `${path}.${i}`)) : [];
}

function object_faults(schema, value, path) {
    const of = name => (path ? `${path}.${name}` : name);
    const missing = (schema.required ?? [])
        .filter(name => !(name in value))
        .map(name => ({ path: of(name), message: 'is missing' }));
    const own = Object.entries(value).flatMap(([name, part]) => {
        if (Object.hasOwn(schema.properties, name)) return faults(schema.properties[name], part, of(name));
        return schema.additionalProperties === false ? [{ path: of(name), message: 'is not a field' }] : [];
    });
    return [...missing, ...own];
}
