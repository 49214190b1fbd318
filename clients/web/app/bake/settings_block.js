// A block of the request's settings as a part of the form that folds: strand, transmittance, ...
import { html, useEffect, useState } from '../../vendor/preact.js';
import { title_text } from '../name_text.js';
import { Field } from './field.js';
import { fault_of } from './form_faults.js';
import { differences, value_at } from './request.js';
import { fields_of } from './schema.js';

/** A part of the form that opens when something in it is wrong, and that only the user closes. */
export function Fold({ title, faulty, children }) {
    const [open, set_open] = useState(faulty);
    useEffect(() => {
        if (faulty) set_open(true);
    }, [faulty]);
    return html`<details class="stage" open=${open} onToggle=${event => set_open(event.currentTarget.open)}>
        <summary>${title}</summary>${children}</details>`;
}

/**
 * name: of the block in `schema`;
 * values: the form's values, base: those that count as unchanged;
 * wrong: what is wrong, by dotted path;
 * on_change(path, value): called with each new value.
 */
export function SettingsBlock({ name, schema, values, base, wrong, on_change }) {
    const part = { properties: { [name]: schema.properties[name] } };
    const changed = differences(part, values, base);
    const bad = Object.keys(wrong).filter(path => path === name || path.startsWith(`${name}.`));
    const note = [changed.length && `${changed.length} changed`, bad.length && `${bad.length} to correct`]
        .filter(Boolean)
        .join(', ');
    const title = title_text(name) + (note && `: ${note}`);
    return html`<${Fold} title=${title} faulty=${bad.length > 0}>
        <p>${schema.properties[name].description}</p>
        <div class="fields">
            ${fields_of(part).map(
                ({ path, schema: field }) => html`<${Field} key=${path.join('.')} path=${path} schema=${field}
                value=${value_at(values, path)} fault=${fault_of(wrong, path)}
                changed=${changed.includes(path.join('.'))}
                on_change=${value => on_change(path, value)} />`,
            )}
        </div>
    <//>`;
}
