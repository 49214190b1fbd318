// The request that repeats a bake and keeps its names.
import { in_new_places } from './request_fields.js';

/**
 * The request of a bake's view. Inputs that the bake refers to by name are named again, each in the
 * bake's version. So a bake of this request uses the same files and follows the same names. Fields stand in their new
 * places.
 */
export function request_by_names({ request, names }) {
    const references = Object.entries(names).map(([field, { path, version }]) => [field, `name:${path}@${version}`]);
    return { ...in_new_places(request), ...Object.fromEntries(references) };
}
