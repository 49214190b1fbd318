// The form that asks for a bake: inputs, a preset, and every setting of the request's schema.
import { html, useRef, useState } from '../../vendor/preact.js';
import { ProblemNote } from '../parts.js';
import { MeshesAndPriority, Outputs } from './form_extras.js';
import { early_faults, faults_of_form, faults_of_problem } from './form_faults.js';
import { use_form_settings } from './form_settings.js';
import { use_form_submit } from './form_submit.js';
import { InputChoice, use_input_choice } from './input_choice.js';
import { Presets } from './presets.js';
import { build_request } from './request.js';
import { block_names } from './schema.js';
import { SettingsBlock } from './settings_block.js';

/** schema, presets: of Api.contract; query: { hair, environment } may hold the digests that are chosen at first. */
export function BakeForm({ schema, presets, query }) {
    const hair = use_input_choice('model', query.hair ?? '');
    const environment = use_input_choice('environment', query.environment ?? '');
    const { settings, base, preset, change, take_preset } = use_form_settings(schema, presets);
    const [waits, set_waits] = useState({}); // by field: why its file is not yet stored
    const form = useRef(null);
    const values = { ...settings, hair: hair.value, environment: environment.value };
    const request = build_request(schema, values);
    const own_faults = faults_of_form(schema, request, waits);
    const { submit, submitted, problem, clear } = use_form_submit(request, own_faults, form);
    const all_faults = { ...own_faults, ...faults_of_problem(problem) };
    const wrong = submitted ? all_faults : early_faults(all_faults, waits);
    const on_change = (path, value) => {
        clear();
        change(path, value);
    };
    const on_preset = name => {
        clear();
        take_preset(name);
    };
    const common = { schema, values, wrong, on_change };
    return html`<form onSubmit=${submit} ref=${form} novalidate>
        <${InputChoice} choice=${hair} title="Hair model" none="None: maps alone"
            fault=${wrong.hair && 'fault-hair'} on_change=${clear} />
        <${InputChoice} choice=${environment} title="Environment" none="None: transmittance alone"
            fault=${wrong.environment && 'fault-environment'} on_change=${clear} />
        ${['hair', 'environment'].map(
            name => wrong[name] && html`<p class="problem" role="alert" id=${`fault-${name}`}>${wrong[name]}</p>`,
        )}
        <${Presets} presets=${presets} value=${preset} on_change=${on_preset} />
        ${block_names(schema).map(
            name => html`<${SettingsBlock} key=${name} name=${name} base=${base} ...${common} />`,
        )}
        <${MeshesAndPriority} ...${common}
            on_wait=${(name, message) => set_waits(old => ({ ...old, [name]: message }))} />
        <${Outputs} ...${common} />
        <${ProblemNote} problem=${problem} />
        <details><summary>The request as JSON</summary><pre tabindex="0">${JSON.stringify(request, null, 2)}</pre>
            </details>
        <button type="submit">Bake</button>
    </form>`;
}
