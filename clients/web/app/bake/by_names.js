// The names that a bake was asked by.

/**
 * The request of a bake's view with those names instead of the digests that the service tells, each in the version that
 * it had: it means the same files, and a bake that is asked for with it follows the same names.
 */
export function request_by_names({ request, names }) {
    const references = Object.entries(names).map(([field, { path, version }]) => [field, `name:${path}@${version}`]);
    return { ...request, ...Object.fromEntries(references) };
}
