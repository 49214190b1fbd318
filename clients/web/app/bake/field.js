// One field of the request as the schema describes it: title, unit, range, help and error message.
import { html, useState } from '../../vendor/preact.js';
import { title_text } from '../name_text.js';
import { number_part, range_text, takes_null, word_of } from './schema.js';

const to_number = text => (text.trim() === '' ? null : Number(text));
const shown = value => (typeof value === 'number' ? String(value) : '');

function NumberInput({ id, schema, value = null, on_change, label, described, invalid }) {
    const part = number_part(schema);
    const [typed, set_typed] = useState('');
    const text = to_number(typed) === value ? typed : shown(value); // "0.0" stays while the user types "0.02"
    const type = event => {
        set_typed(event.target.value);
        on_change(to_number(event.target.value));
    };
    return html`<input id=${id} type="number" step=${part.type === 'integer' ? 1 : 'any'} min=${part.minimum}
        max=${part.maximum}
        value=${text} aria-label=${label} aria-describedby=${described} aria-invalid=${invalid ? 'true' : null}
        placeholder=${takes_null(schema) ? 'as the file says' : null}
        onInput=${type} />`;
}

/** A number, or the word that the schema allows instead, such as auto. */
function NumberOrWord({ id, schema, value, on_change, described, invalid }) {
    const word = word_of(schema);
    const part = number_part(schema);
    const is_word = value === word;
    const first = part.maximum > 1 ? 8 : 1; // the value after the word is switched off
    return html`<div class="row">
        <${NumberInput} id=${id} schema=${schema} value=${is_word ? null : value} on_change=${on_change}
            described=${described} invalid=${invalid} />
        <label><input type="checkbox" checked=${is_word}
            onChange=${event => on_change(event.target.checked ? word : first)} /> ${title_text(word)}</label>
    </div>`;
}

/** The rest of a fault's place below `name`: '' means all of it, null means that the fault is elsewhere. */
function below(place, name) {
    if (place === '' || place === name) return '';
    return place?.startsWith(`${name}.`) ? place.slice(name.length + 1) : null;
}

function Triple({ schema, value, on_change, described, place, title, parts = ['X', 'Y', 'Z'] }) {
    return html`<div class="row">${parts.map(
        (part, i) => html`<${NumberInput} key=${part} schema=${schema.items} value=${value?.[i]}
        label=${`${title}, ${part}`} described=${described} invalid=${below(place, String(i)) !== null}
        on_change=${number => on_change(value.map((old, j) => (j === i ? number : old)))} />`,
    )}</div>`;
}

const output_help = {
    npy: 'numpy arrays',
    exr: 'maps for Unity, Blender, Godot 4, three.js',
    hair: 'the model with A as vertex colours',
    ktx2: 'KTX 2 cube arrays',
    dds: 'cube maps with mip levels: Unreal, Godot 4',
    raw: 'half floats: this page, WebGL, WebGPU',
    glb: 'glTF lines with A',
    vdb: 'the density grid: Blender, OpenVDB',
};

function Choices({ schema, value, on_change, described, invalid }) {
    return html`<div class="fields">${schema.items.enum.map(
        one => html`<label key=${one}>
        <input type="checkbox" checked=${value.includes(one)} aria-describedby=${invalid ? described : null}
            aria-invalid=${invalid ? 'true' : null} onChange=${event =>
            on_change(
                schema.items.enum.filter(other => (other === one ? event.target.checked : value.includes(other))),
            )} />
        ${' '}${one}${output_help[one] ? `: ${output_help[one]}` : ''}</label>`,
    )}</div>`;
}

function Lights({ schema, value, on_change, described, place }) {
    const change = (i, name, part) =>
        on_change(value.map((light, j) => (j === i ? { ...light, [name]: part } : light)));
    const fresh = { direction: [0, 1, 0], irradiance: [1, 1, 1] };
    return html`<div>
        ${value.map(
            (light, i) => html`<div class="light" key=${i} role="group" aria-label=${`Light ${i + 1}`}>
            <div>Direction <${Triple} schema=${schema.items.properties.direction} value=${light.direction}
                title=${`Light ${i + 1}, direction`} described=${described} place=${below(place, `${i}.direction`)}
                on_change=${part => change(i, 'direction', part)} /></div>
            <div>Irradiance <${Triple} schema=${schema.items.properties.irradiance} value=${light.irradiance}
                title=${`Light ${i + 1}, irradiance`} described=${described} place=${below(place, `${i}.irradiance`)}
                parts=${['R', 'G', 'B']} on_change=${part => change(i, 'irradiance', part)} /></div>
            <button type="button" class="small secondary outline"
                onClick=${() => on_change(value.filter((_, j) => j !== i))}>Remove light ${i + 1}</button>
        </div>`,
        )}
        <button type="button" class="small outline" disabled=${value.length >= schema.maxItems}
            onClick=${() => on_change([...value, fresh])}>Add a light</button>
    </div>`;
}

// [component, whether it is a group of inputs]
function control_of(schema) {
    if (schema.type === 'array' && schema.items.properties?.irradiance) return [Lights, true];
    if (schema.type === 'array' && schema.items.enum) return [Choices, true];
    if (schema.type === 'array') return [Triple, true];
    if (schema.anyOf) return [NumberOrWord, false];
    if (schema.enum) return [Select, false];
    return [NumberInput, false];
}

function Select({ id, schema, value, on_change, described, invalid }) {
    return html`<select id=${id} aria-describedby=${described} aria-invalid=${invalid ? 'true' : null}
        onChange=${event => on_change(event.target.value)}>
        ${schema.enum.map(one => html`<option key=${one} value=${one} selected=${one === value}>${one}</option>`)}
    </select>`;
}

function Help({ id, schema, fault }) {
    const range = schema.enum || schema.items?.enum ? '' : range_text(schema); // lists show the allowed values
    return html`<small id=${`${id}-help`}>${schema.description}${range && ` (${range}.)`}</small>
        ${fault && html`<small class="problem" id=${`${id}-fault`}>${fault.message}</small>`}`;
}

/** "Face size, texels", "SH bands: diffuse". */
function title_of(path, unit) {
    const titles = path.slice(path.length > 2 ? -2 : -1).map(title_text);
    const title = titles.length > 1 ? `${titles[0]}: ${titles[1].toLowerCase()}` : titles[0];
    return unit && !title.toLowerCase().includes(unit) ? `${title}, ${unit}` : title;
}

/**
 * path: names of the blocks and of the field; schema: of the field;
 * fault: { message, place }, undefined if nothing is wrong; place: the wrong part of the value, '' for all of it;
 * changed: whether the value differs from the preset's.
 */
export function Field({ path, schema, value, on_change, fault, changed }) {
    const id = `field-${path.join('-')}`;
    const title = title_of(path, schema['x-unit']);
    const invalid = Boolean(fault);
    const described = invalid ? `${id}-help ${id}-fault` : `${id}-help`;
    const common = { id, schema, value, on_change, described, invalid, place: fault?.place, title };
    const mark = `field ${changed ? 'changed' : ''}`;
    const help = html`<${Help} id=${id} schema=${schema} fault=${fault} />`;
    if (schema.type === 'boolean')
        return html`<div class=${mark}><label><input id=${id} type="checkbox" role="switch" checked=${value}
            aria-describedby=${described} aria-invalid=${invalid ? 'true' : null}
            onChange=${event => on_change(event.target.checked)} /> ${title}</label>${help}</div>`;
    const [Control, is_group] = control_of(schema);
    const parts = path.at(-1) === 'tint' ? ['R', 'G', 'B'] : undefined;
    if (is_group)
        return html`<div class=${`${mark} ${Control === Triple ? '' : 'wide'}`}><fieldset><legend>${title}</legend>
            <${Control} ...${common} parts=${parts} />${help}</fieldset></div>`;
    return html`<div class=${mark}><label for=${id}>${title}</label><${Control} ...${common} />${help}</div>`;
}
