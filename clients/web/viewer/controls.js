// The panels beside the picture: what is shown, hair, sky, lights. Each takes a value and calls `on` with a new one.
import { html } from '../vendor/preact.js';
import { Choice, Color, Slider, Tick } from './fields.js';
import { most_lights } from './hair_shader.js';
import { new_light } from './lighting_edit.js';

const parts = {
    all: 'Diffuse and specular',
    diffuse: 'Diffuse only',
    specular: 'Specular only',
    transmittance: 'A only',
};
const hiding = {
    automatic: 'The best the bake has',
    harmonics: 'Directional transmittance',
    cone: 'Bent cone',
    average: 'A alone',
};

/** sides: one or two of hair_view.js; names: label of each bake; is_edited: whether the lighting is edited. */
export function SidesPanel({ sides, names, is_edited, on }) {
    const two = sides.length === 2;
    const split = !two ? 'one' : sides[1].bake === sides[0].bake ? 'same' : 'both';
    const choices = {
        one: 'One picture',
        same: 'Two pictures of one bake',
        ...(names.length > 1 && { both: 'Two bakes' }),
    };
    const set_split = way => on(split_sides(sides, way));
    const change = (k, side) => on(sides.map((old, i) => (i === k ? side : old)));
    return html`<fieldset>
        <legend>What is shown</legend>
        <${Choice} label="Split" value=${split} options=${choices} on=${set_split} />
        ${sides.map(
            (side, k) => html`<${SidePanel} key=${k} side=${side} names=${names}
            is_edited=${is_edited} on=${changed => change(k, changed)}
            where=${two ? ['Left: ', 'Right: '][k] : ''} />`,
        )}
    </fieldset>`;
}

function split_sides([first, second], way) {
    if (way === 'one') return [first];
    if (way === 'same') return [first, { ...first, with_transmittance: !first.with_transmittance }];
    return [
        { ...first, bake: 0 },
        { ...(second ?? first), with_transmittance: first.with_transmittance, bake: 1 },
    ];
}

function SidePanel({ side, names, is_edited, where, on }) {
    const bakes = Object.fromEntries(names.map((name, i) => [i, name]));
    return html`
        ${
            names.length > 1 &&
            html`<${Choice} label=${`${where}Bake`} value=${String(side.bake)} options=${bakes}
            on=${bake => on({ ...side, bake: Number(bake) })} />`
        }
        <${Choice} label=${`${where}Part`} value=${side.part} options=${parts} on=${part => on({ ...side, part })} />
        <${Tick} label=${`${where}Times A (what the hair lets through)`} checked=${side.with_transmittance}
            disabled=${side.part === 'transmittance'}
            on=${with_transmittance => on({ ...side, with_transmittance })} />
        <${Tick} label=${`${where}As baked, without the edit`} checked=${side.as_baked} disabled=${!is_edited}
            on=${as_baked => on({ ...side, as_baked })} />`;
}

export function HairPanel({ look, exponent, on }) {
    return html`<fieldset>
        <legend>Hair</legend>
        <${Slider} label="Albedo (Kd π²)" value=${look.albedo} min="0" max="1"
            on=${albedo => on({ ...look, albedo })} />
        <${Color} label="Colour" value=${look.color} on=${color => on({ ...look, color })} />
        <${Slider} label="Specular Ks" value=${look.specular} min="0" max="0.5" step="0.005"
            on=${specular => on({ ...look, specular })} />
        <p class="viewer-note">Exponent ${exponent}, as baked.</p>
    </fieldset>`;
}

export function SkyPanel({ edit, on }) {
    const turn = axis => angle =>
        on({ ...edit, rotation_deg: edit.rotation_deg.map((old, i) => (i === axis ? angle : old)) });
    const tint = channel => factor => on({ ...edit, tint: edit.tint.map((old, i) => (i === channel ? factor : old)) });
    const turning = (label, axis) =>
        html`<${Slider} label=${label} value=${edit.rotation_deg[axis]} min="-180" max="180" step="1" unit="°"
            on=${turn(axis)} />`;
    return html`<fieldset>
        <legend>Sky</legend>
        ${turning('Turn about the vertical (Y)', 1)}
        <${Slider} label="Exposure" value=${edit.exposure_stops} min="-6" max="6" step="0.1" unit="stops"
            on=${exposure_stops => on({ ...edit, exposure_stops })} />
        <details>
            <summary>Tilt and tint</summary>
            ${turning('Tilt about X, before Y', 0)} ${turning('Tilt about Z, after Y', 2)}
            ${['red', 'green', 'blue'].map(
                (name, i) => html`<${Slider} label=${`Tint ${name}`} value=${edit.tint[i]} min="0" max="2"
                on=${tint(i)} />`,
            )}
        </details>
    </fieldset>`;
}

/**
 * way: how the hair blocks the lights; ways: those that the bakes shown support;
 * level: mean of the sky's diffuse map, the scale of the lights' irradiance.
 */
export function LightsPanel({ lights, level, way, ways, on, on_way }) {
    const change = (k, more) => on(lights.map((light, i) => (i === k ? { ...light, ...more } : light)));
    const options = Object.fromEntries(Object.entries(hiding).filter(([key]) => ways.includes(key)));
    return html`<fieldset>
        <legend>Added lights</legend>
        ${lights.map(
            (
                light,
                k,
            ) => html`<${LightPanel} key=${k} number=${k + 1} level=${level} light=${light}
            on=${more => change(k, more)} remove=${() => on(lights.filter((_, i) => i !== k))} />`,
        )}
        <button type="button" class="secondary" disabled=${lights.length >= most_lights}
            onClick=${() => on([...lights, new_light(level)])}>Add a light</button>
        ${
            lights.length > 0 &&
            html`<${Choice} label="Hair blocks added lights by" value=${way} options=${options} on=${on_way} />`
        }
    </fieldset>`;
}

function LightPanel({ number, level, light, on, remove }) {
    return html`<details open>
        <summary>Light ${number}</summary>
        <${Slider} label="Azimuth" value=${light.azimuth_deg} min="-180" max="180" step="1" unit="°"
            on=${azimuth_deg => on({ azimuth_deg })} />
        <${Slider} label="Elevation" value=${light.elevation_deg} min="-90" max="90" step="1" unit="°"
            on=${elevation_deg => on({ elevation_deg })} />
        <${Slider} label="Irradiance" value=${light.irradiance} min="0" max=${10 * level} step=${level / 20}
            on=${irradiance => on({ irradiance })} />
        <${Color} label="Colour" value=${light.color} on=${color => on({ color })} />
        <button type="button" class="secondary" onClick=${remove}>Remove light ${number}</button>
    </details>`;
}
