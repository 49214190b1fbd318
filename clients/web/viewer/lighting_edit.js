// An edit of the lighting in the viewer, and the request that bakes it. Matrices are lists of rows.
//
// A bake's lighting is  R0 (environment) 2^e0 tint0 + lights0;  the edit turns, exposes and tints all of that and adds
// lights of its own. So the request that bakes the edit has the rotation R R0, the stops e0 + e, the tint tint0 tint,
// the old lights turned, exposed and tinted, and the new ones.
import { environment_settings_of, in_new_places } from '../app/bake/request_fields.js';

/** `rotation_deg` and the lights are in the world frame; a light's azimuth 0 is +Z, 90 is +X, as the camera's. */
export function no_edit() {
    return { rotation_deg: [0, 0, 0], exposure_stops: 0, tint: [1, 1, 1], lights: [] };
}

/** `irradiance`: RGB is this times the colour. */
export function new_light(irradiance) {
    return { azimuth_deg: 45, elevation_deg: 45, irradiance, color: [1, 1, 1] };
}

export function is_edited(edit) {
    return JSON.stringify(edit) !== JSON.stringify(no_edit());
}

/** Active, right-handed: about world X first, then Y, then Z (the request's rotation_deg). */
export function rotation_matrix(degrees) {
    const [cx, cy, cz] = degrees.map(angle => Math.cos((angle * Math.PI) / 180));
    const [sx, sy, sz] = degrees.map(angle => Math.sin((angle * Math.PI) / 180));
    return [
        [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
        [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ];
}

/**
 * Angles whose rotation_matrix is `m`, to 1e-9 degrees. With Y at 90 degrees, X and Z turn about one axis; then Z is 0.
 */
export function rotation_degrees(m) {
    const y = Math.atan2(-m[2][0], Math.hypot(m[2][1], m[2][2]));
    const level = Math.hypot(m[2][1], m[2][2]) > 1e-9;
    const x = level ? Math.atan2(m[2][1], m[2][2]) : Math.atan2(-m[1][2], m[1][1]);
    const z = level ? Math.atan2(m[1][0], m[0][0]) : 0;
    return [x, y, z].map(angle => tidy((angle * 180) / Math.PI));
}

export function multiply(a, b) {
    return a.map(row => [0, 1, 2].map(j => row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]));
}

export function transform(m, [x, y, z]) {
    return m.map(row => row[0] * x + row[1] * y + row[2] * z);
}

/** Towards a light: unit vector. */
export function light_direction({ azimuth_deg, elevation_deg }) {
    const azimuth = (azimuth_deg * Math.PI) / 180,
        elevation = (elevation_deg * Math.PI) / 180;
    const level = Math.cos(elevation);
    return [level * Math.sin(azimuth), Math.sin(elevation), level * Math.cos(azimuth)];
}

export function light_irradiance({ irradiance, color }) {
    return color.map(channel => channel * irradiance);
}

/** The factor of exposure and tint on radiance, RGB. */
export function gain_of(edit) {
    return edit.tint.map(factor => factor * 2 ** edit.exposure_stops);
}

/** The lighting that a request gives, from either place of its fields: an edit's fields, lights as in the request. */
function lighting_of(request) {
    const { rotation_deg, exposure_stops, tint } = { ...no_edit(), ...environment_settings_of(request) };
    return { rotation_deg, exposure_stops, tint, lights: request.irradiance?.lights ?? [] };
}

function edited_lights(old, edit) {
    const rotation = rotation_matrix(edit.rotation_deg);
    const gain = gain_of(edit);
    return [
        ...old.map(({ direction, irradiance }) => ({
            direction: is_turned(edit) ? transform(rotation, direction).map(tidy) : direction,
            irradiance: irradiance.map((channel, i) => tidy(channel * gain[i])),
        })),
        ...edit.lights.map(light => ({
            direction: light_direction(light).map(tidy),
            irradiance: light_irradiance(light).map(tidy),
        })),
    ];
}

const is_turned = edit => edit.rotation_deg.some(angle => angle % 360 !== 0);

/**
 * The request that bakes the lighting of `request` as edited; its fields stand in their new places. Throws an Error
 * with a message where the service would refuse the request.
 */
export function compose_request(request, edit) {
    const before = lighting_of(request);
    const turned = multiply(rotation_matrix(edit.rotation_deg), rotation_matrix(before.rotation_deg));
    const sky = {
        rotation_deg: is_turned(edit) ? rotation_degrees(turned) : before.rotation_deg,
        exposure_stops: tidy(before.exposure_stops + edit.exposure_stops),
        tint: before.tint.map((factor, i) => tidy(factor * edit.tint[i])),
    };
    const lights = edited_lights(before.lights, edit);
    refuse_beyond_limits(sky, lights);
    const moved = in_new_places(request);
    return {
        ...moved,
        environment_settings: { ...moved.environment_settings, ...sky },
        irradiance: { ...moved.irradiance, lights },
    };
}

/** The changes that a request makes to its environment, as texts for the user. */
export function lighting_text(request) {
    const { rotation_deg, exposure_stops, tint, lights } = lighting_of(request);
    const [x, y, z] = rotation_deg.map(angle => `${Number(angle.toFixed(1))}°`);
    const texts = [];
    if (rotation_deg[0] || rotation_deg[2]) texts.push(`sky turned by ${x} ${y} ${z} about X Y Z`);
    else if (rotation_deg[1]) texts.push(`sky turned by ${y}`);
    if (exposure_stops) texts.push(`${exposure_stops > 0 ? '+' : ''}${Number(exposure_stops.toFixed(2))} stops`);
    if (tint.some(factor => factor !== 1)) texts.push('tinted');
    if (lights.length) texts.push(`${lights.length} ${lights.length === 1 ? 'light' : 'lights'} added`);
    return texts;
}

function refuse_beyond_limits({ exposure_stops }, lights) {
    if (Math.abs(exposure_stops) > 64)
        throw new Error(`The exposure would be ${exposure_stops} stops in all; a bake takes -64 to 64.`);
    if (lights.length > 64) throw new Error(`There would be ${lights.length} lights in all; a bake takes at most 64.`);
}

/** Rounds to twelve digits, so that rounding errors do not appear in the request. */
function tidy(value) {
    return Math.abs(value) < 1e-9 ? 0 : Number(value.toPrecision(12));
}
