// The places of a request's fields. Requests of older bakes and manifests hold the fibre model and the environment's
// settings in the block `irradiance`; now they stand in the blocks `fiber` and `environment_settings`.

const environment_fields = ['layout', 'latlong', 'rotation_deg', 'exposure_stops', 'tint', 'invalid_radiance'];

// Name of the old field in `irradiance` -> path of the field now.
const new_paths = {
    model: ['fiber', 'model'],
    exponent: ['fiber', 'kajiya_kay', 'exponent'],
    ...Object.fromEntries(environment_fields.map(name => [name, ['environment_settings', name]])),
};

/** A copy of `block` with `value` at `path`, unless there is a value already. */
function filled_in(block, [name, ...rest], value) {
    const old = block?.[name];
    return { ...block, [name]: rest.length > 0 ? filled_in(old, rest, value) : (old ?? value) };
}

/** The same request with every field in its new place. Where both places hold a value, the new place wins. */
export function in_new_places(request) {
    const { irradiance, ...rest } = request;
    if (!irradiance) return request;
    const old = Object.entries(irradiance).filter(([name]) => Object.hasOwn(new_paths, name));
    if (old.length === 0) return request;
    const kept = Object.entries(irradiance).filter(([name]) => !Object.hasOwn(new_paths, name));
    const moved = old.reduce((part, [name, value]) => filled_in(part, new_paths[name], value), rest);
    return kept.length > 0 ? { ...moved, irradiance: Object.fromEntries(kept) } : moved;
}

/** How a request reads its environment, from either place: the fields that it gives. */
export const environment_settings_of = request => in_new_places(request).environment_settings ?? {};
