// Chooses a stored model or environment by its thumbnail, and the name or digest by which the request refers to it.
import { html } from '../../vendor/preact.js';
import { label_of, summary } from '../input_facts.js';
import { Cut } from '../parts.js';

/**
 * value: a digest or ''; inputs: of use_inputs; none: label of the choice of no file, if there is one;
 * fault: id of the element with the error message, if something is wrong.
 */
export function Picker({ kind, title, inputs, value, on_change, none, fault }) {
    const { items, more, names, files } = inputs;
    const name = `picker-${title}`;
    const choose = id => () => on_change(id);
    return html`<fieldset role="radiogroup" aria-invalid=${fault ? 'true' : null} aria-describedby=${fault}>
        <legend><strong>${title}</strong></legend>
        ${items?.length === 0 && html`<p>None is stored yet: <a href=${`#/${kind}s`}>send one</a>.</p>`}
        <div class="choices" hidden=${!none && items?.length === 0}>
            ${none && html`<label class="choice"><input type="radio" name=${name} checked=${value === ''}
                onChange=${choose('')} /> ${none}</label>`}
            ${(items ?? []).map(
                entry => html`<label class="choice" key=${entry.id}>
                <input type="radio" name=${name} value=${entry.id} checked=${entry.id === value}
                    onChange=${choose(entry.id)} />
                ${' '}${label_of(entry.id, names, files)}
                <img src=${entry.links.thumbnail} alt="" loading="lazy" /><small>${summary(entry)}</small>
            </label>`,
            )}
        </div>
        <${Cut} more=${more} />
    </fieldset>`;
}

/** How the request refers to the chosen file: by one of `names` (see names_of), or by its digest. */
export function Reference({ title, names, value, on_change }) {
    const id = `reference-${title.replaceAll(' ', '-')}`;
    if (names.length === 0) return null;
    return html`<div class="field"><label for=${id}>${title}: reference</label>
        <select id=${id} aria-describedby=${`${id}-help`} onChange=${event => on_change(event.target.value)}>
            ${names.map(name => html`<option key=${name} value=${name} selected=${value === name}>${name}</option>`)}
            <option value="" selected=${!value.startsWith('name:')}>this file</option>
        </select>
        <small id=${`${id}-help`}>A bake that refers to a name can be baked again with the name's new versions.</small>
    </div>`;
}
