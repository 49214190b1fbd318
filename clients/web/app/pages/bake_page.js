// A request, field by field, as the schema of the service has it.
import { html, useEffect, useMemo, useRef, useState } from '../../vendor/preact.js';
import { Field } from '../bake/field.js';
import { MeshField } from '../bake/mesh_field.js';
import { Picker, Reference } from '../bake/picker.js';
import {
    build_request,
    differences,
    first_values,
    merged,
    names_of,
    reference_to,
    value_at,
    with_value,
} from '../bake/request.js';
import { faults, fields_of } from '../bake/schema.js';
import { use_inputs } from '../gallery.js';
import { use_app } from '../hooks.js';
import { Loading, ProblemNote } from '../parts.js';
import { title_text } from '../name_text.js';
import { count_text } from '../number_text.js';

const stages = ['strand', 'transmittance', 'irradiance'];

/** A part of the form: what is wrong in it opens it, people alone close it. */
function Fold({ title, faulty, children }) {
    const [open, set_open] = useState(faulty);
    useEffect(() => {
        if (faulty) set_open(true);
    }, [faulty]);
    return html`<details class="stage" open=${open} onToggle=${event => set_open(event.currentTarget.open)}>
        <summary>${title}</summary>${children}</details>`;
}

function Stage({ name, schema, values, base, wrong, on_change }) {
    const part = { properties: { [name]: schema.properties[name] } };
    const changed = differences(part, values, base);
    const bad = Object.keys(wrong).filter(path => path.startsWith(name));
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

/** Brings the focus to the first field that is wrong, also in a part of the form that is closed. */
function focus_first_fault(form) {
    const wrong = form.querySelector('[aria-invalid=true]');
    for (let fold = wrong?.closest('details'); fold; fold = fold.parentElement.closest('details')) fold.open = true;
    const field = wrong?.matches('fieldset') ? wrong.querySelector('input') : wrong;
    (field ?? form.querySelector('.problem'))?.scrollIntoView({ block: 'center' });
    field?.focus({ preventScroll: true });
}

// Also that of a part of it: "irradiance.tint.2".
function fault_of(wrong, path) {
    const own = path.join('.');
    const found = Object.keys(wrong).find(other => other === own || other.startsWith(`${own}.`));
    return found && { words: wrong[found], place: found.slice(own.length + 1) };
}

/** What this page finds wrong by itself, by field: words. `waits`: by field, the file that is not there yet. */
function faults_of_form(schema, request, waits) {
    const wrong = Object.fromEntries(
        faults(schema, request).map(({ path, words }) => [path, `${title_text(path)} ${words}.`]),
    );
    if (!request.hair && !request.environment) wrong.hair = 'A hair model, an environment, or one of each is needed.';
    for (const [name, words] of Object.entries(waits)) if (words) wrong[name] = words;
    return wrong;
}

function Presets({ presets, value, on_change }) {
    const chosen = presets.find(({ name }) => name === value);
    return html`<div class="field"><label for="preset">Preset</label>
        <select id="preset" aria-describedby="preset-help" onChange=${event => on_change(event.target.value)}>
            <option value="">default</option>
            ${presets.map(({ name }) => html`<option key=${name} value=${name} selected=${name === value}>${name}
                </option>`)}
        </select>
        <small id="preset-help">
            ${chosen?.description ?? 'Every field as the service sets it when a request leaves it out.'}</small>
    </div>`;
}

function Form({ schema, presets, query }) {
    const { api, announce } = use_app();
    const models = use_inputs('model');
    const environments = use_inputs('environment');
    const start = useMemo(() => first_values(schema), [schema]);
    const [preset, set_preset] = useState('');
    const [base, set_base] = useState(start);
    const [settings, set_settings] = useState(start);
    const [hair, set_hair] = useState({ id: query.hair ?? '' });
    const [environment, set_environment] = useState({ id: query.environment ?? '' });
    const [waits, set_waits] = useState({}); // by field: the file that is not there yet, in words
    const [asked, set_asked] = useState(false);
    const [problem, set_problem] = useState(null);
    const form = useRef(null);

    const values = {
        ...settings,
        hair: reference_to(hair, models),
        environment: reference_to(environment, environments),
    };
    const request = build_request(schema, values);
    const own_faults = faults_of_form(schema, request, waits);
    const wrong = { ...own_faults };
    if (problem?.field) wrong[problem.field.replaceAll(/\[(\d+)\]/g, '.$1')] = problem.message;
    const change = (path, value) => {
        set_problem(null);
        set_settings(old => with_value(old, path, value));
    };
    const choose = (set, chosen) => {
        set_problem(null);
        set(chosen);
    };
    const take_preset = name => {
        const fresh = merged(start, presets.find(one => one.name === name)?.request ?? {});
        set_problem(null);
        const { occluder, receiver, outputs } = settings;
        set_preset(name);
        set_base(fresh);
        set_settings({ ...fresh, occluder, receiver, outputs });
    };
    const show_fault = () => setTimeout(() => focus_first_fault(form.current)); // once it is drawn
    const submit = async event => {
        event.preventDefault();
        set_asked(true);
        set_problem(null); // what the service refused may be there by now: it is asked again
        const count = Object.keys(own_faults).length;
        if (count) {
            announce(`${count_text(count, 'field')} to correct.`);
            show_fault();
            return;
        }
        try {
            const { id } = await api.post('/v1/bakes', request);
            location.hash = `#/bakes/${id}`;
        } catch (failure) {
            set_problem(failure);
            show_fault();
        }
    };
    const later = path => path === 'hair' || waits[path]; // shown only to who wants to go on nevertheless
    const visible = asked ? wrong : Object.fromEntries(Object.entries(wrong).filter(([path]) => !later(path)));
    return html`<form onSubmit=${submit} ref=${form} novalidate>
        <${Picker} kind="model" title="Hair model" inputs=${models} value=${hair.id} none="None: maps alone"
            fault=${visible.hair && 'fault-hair'} on_change=${id => choose(set_hair, { id })} />
        <${Reference} title="Hair model" names=${names_of(hair.id, models)} value=${values.hair}
            on_change=${by => choose(set_hair, { ...hair, by })} />
        <${Picker} kind="environment" title="Environment" inputs=${environments} value=${environment.id}
            none="None: transmittance alone" fault=${visible.environment && 'fault-environment'}
            on_change=${id => choose(set_environment, { id })} />
        <${Reference} title="Environment" names=${names_of(environment.id, environments)} value=${values.environment}
            on_change=${by => choose(set_environment, { ...environment, by })} />
        ${['hair', 'environment'].map(
            name => visible[name] && html`<p class="problem" role="alert" id=${`fault-${name}`}>${visible[name]}</p>`,
        )}
        <${Presets} presets=${presets} value=${preset} on_change=${take_preset} />
        ${stages.map(name => html`<${Stage} key=${name} name=${name} schema=${schema} values=${values} base=${base}
            wrong=${visible} on_change=${change} />`)}
        <${Fold} title="Meshes and priority"
            faulty=${['occluder', 'receiver', 'priority'].some(name => visible[name])}><div class="fields">
            ${['occluder', 'receiver'].map(
                name => html`<${MeshField} key=${name} name=${name} schema=${schema.properties[name]}
                    value=${values[name]}
                    fault=${visible[name]} on_change=${value => change([name], value)}
                    on_wait=${words => set_waits(old => ({ ...old, [name]: words }))} />`,
            )}
            <${Field} path=${['priority']} schema=${schema.properties.priority} value=${values.priority}
                fault=${fault_of(visible, ['priority'])}
                on_change=${value => change(['priority'], value)} />
        </div><//>
        <${Field} path=${['outputs']} schema=${schema.properties.outputs} value=${values.outputs}
            fault=${fault_of(visible, ['outputs'])}
            on_change=${value => change(['outputs'], value)} />
        ${!values.outputs.includes('raw') && html`<p
            class="help">Without raw, this page has no maps, histogram or viewer for the bake.</p>`}
        <${ProblemNote} problem=${problem} />
        <details><summary>The request as JSON</summary><pre tabindex="0">${JSON.stringify(request, null, 2)}</pre>
            </details>
        <button type="submit">Bake</button>
    </form>`;
}

export default function BakePage({ query }) {
    const { api } = use_app();
    const [state, set_state] = useState({});
    useEffect(() => {
        api.contract().then(
            contract => set_state({ contract }),
            problem => set_state({ problem }),
        );
    }, []);
    if (state.problem) return html`<${ProblemNote} problem=${state.problem} />`;
    if (!state.contract) return html`<${Loading} what="the form" />`;
    return html`<${Form} ...${state.contract} query=${query} />`;
}
