// The page that bakes a set of bakes again under another environment.
import { html, useState } from '../../vendor/preact.js';
import { Picker } from '../bake/picker.js';
import { Rebake } from '../bake/rebake.js';
import { use_inputs } from '../gallery.js';
import { use_list } from '../hooks.js';
import { label_of } from '../input_facts.js';
import { Cut, ProblemNote } from '../parts.js';
import { count_text } from '../number_text.js';

function OldEnvironment({ inputs, value, on_change }) {
    return html`<label>Environment <select onChange=${event => on_change(event.target.value)}>
        <option value="">choose</option>
        ${(inputs.items ?? []).map(({ id }) => html`<option key=${id} value=${id} selected=${id === value}>
            ${label_of(id, inputs.names, inputs.files)}</option>`)}
    </select></label><${Cut} more=${inputs.more} />`;
}

function OldName({ value, on_change }) {
    const { items, more } = use_list('/v1/names/environment', 'names');
    return html`<label>Name <select onChange=${event => on_change(event.target.value)}>
        <option value="">choose</option>
        ${(items ?? []).map(({ path }) => html`<option key=${path} value=${path} selected=${path === value}>${path}
            </option>`)}
    </select></label><${Cut} more=${more} />`;
}

/** The part of the request that selects the bakes, or null while nothing is selected. */
function source_of(how, { bakes, replaces, name }) {
    if (how === 'bakes') return bakes.length ? { bakes } : null;
    if (how === 'replaces') return replaces ? { replaces: `sha256:${replaces}` } : null;
    return name ? { name } : null;
}

export default function RebakePage({ query }) {
    const environments = use_inputs('environment');
    const bakes = query.bakes ? query.bakes.split(',') : [];
    const [how, set_how] = useState(bakes.length ? 'bakes' : query.name ? 'name' : 'replaces');
    const [replaces, set_replaces] = useState(query.replaces ?? '');
    const [name, set_name] = useState(query.name ?? '');
    const [target, set_target] = useState('');
    const source = source_of(how, { bakes, replaces, name });
    const selections = [
        ...(bakes.length ? [['bakes', `The ${count_text(bakes.length, 'chosen bake')}`]] : []),
        ['replaces', 'Every bake under an environment'],
        ['name', 'Every bake that refers to an environment by a name'],
    ];
    return html`<div>
        <p>The transmittance does not depend on the lighting: it is reused, and only
            irradiance maps are computed, once for all models with the same settings.</p>
        <fieldset><legend><strong>What to bake again</strong></legend>
            ${selections.map(([value, label]) => html`<label key=${value}><input type="radio" name="how"
                checked=${how === value} onChange=${() => set_how(value)} /> ${label}</label>`)}
        </fieldset>
        ${how === 'replaces' && html`<${OldEnvironment} inputs=${environments} value=${replaces}
            on_change=${set_replaces} />`}
        ${how === 'name' && html`<${OldName} value=${name} on_change=${set_name} />`}
        ${how === 'bakes' && html`<p><a href="#/bakes">Choose others</a></p>`}
        <${Picker} kind="environment" title="New environment" inputs=${environments} value=${target}
            on_change=${set_target} />
        <${ProblemNote} problem=${environments.problem} />
        <${Rebake} request=${source && target ? { environment: `sha256:${target}`, ...source } : null} />
    </div>`;
}
