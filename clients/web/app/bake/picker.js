// Choosing one of the stored models or environments, by picture.
import { html } from '../../vendor/preact.js';
import { label_of, summary } from '../input_facts.js';

/** value: a digest or ''; inputs: what use_inputs gives. */
export function Picker({ kind, title, inputs, value, on_change, none }) {
    const { items, names, files } = inputs;
    const name = `picker-${title}`;
    const choose = id => () => on_change(id);
    return html`<fieldset><legend><strong>${title}</strong></legend>
        ${items?.length === 0 && html`<p>None is stored yet: <a href=${`#/${kind}s`}>send one</a>.</p>`}
        <div class="choices">
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
    </fieldset>`;
}
