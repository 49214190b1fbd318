// A name: its versions, a new version, and the bakes that use it, which can be baked again with the newest version.
import { html, useMemo, useState } from '../../vendor/preact.js';
import { BakeTable } from '../bake/bake_table.js';
import { request_by_names } from '../bake/by_names.js';
import { Rebake } from '../bake/rebake.js';
import { name_address, use_inputs } from '../gallery.js';
import { use_app, use_json, use_list } from '../hooks.js';
import { label_of } from '../input_facts.js';
import { Cut, Heads, Loading, ProblemNote } from '../parts.js';
import { file_names } from '../uploads/uploads.js';
import { count_text } from '../number_text.js';
import { time_text } from '../time_text.js';

function Versions({ versions, inputs }) {
    return html`<div class="scroll" tabindex="0" role="region" aria-label="Versions"><table class="striped">
        <${Heads} titles=${['Version', 'File', 'Note', 'By', 'When']} />
        <tbody>${versions.map(
            one => html`<tr key=${one.version}><td>${one.version}</td><td>${label_of(one.sha256, {}, inputs.files)}</td>
            <td>${one.note}</td><td>${one.token}</td><td>${time_text(one.created)}</td></tr>`,
        )}</tbody>
    </table></div>`;
}

/** The fields of a request that can refer to a name of a kind. */
const fields = { model: ['hair'], environment: ['environment'], mesh: ['occluder', 'receiver'] };

/** The fields in which a bake refers to the name. */
const fields_with = (bake, { kind, path }) => fields[kind].filter(field => bake.names[field]?.path === path);

function NewVersion({ kind, name, inputs, on_change }) {
    const { api, announce } = use_app();
    const [problem, set_problem] = useState(null);
    const put = async event => {
        event.preventDefault();
        const form = new FormData(event.target);
        try {
            const { version } = await api.put(name_address(kind, name.path), {
                sha256: form.get('sha256'),
                note: form.get('note'),
            });
            announce(`${name.path} is now version ${version}.`);
            on_change();
        } catch (failure) {
            set_problem(failure);
        }
    };
    const others = (inputs.items ?? []).filter(({ id }) => id !== name.sha256);
    if (others.length === 0)
        return html`<p>No other file is stored that the name could point at: <a href=${`#/${kind}s`}>send one</a>.</p>`;
    return html`<form onSubmit=${put} class="toolbar">
        <label class="grow">File <select name="sha256" required>
            ${others.map(({ id }) => html`<option key=${id} value=${id}>${label_of(id, inputs.names, inputs.files)}
                </option>`)}</select></label>
        <label class="grow">Note <input name="note" maxlength="500" /></label>
        <button type="submit" class="small">Put as version ${name.version + 1}</button>
        <${ProblemNote} problem=${problem} />
    </form>`;
}

/** Bakes again with a new model or mesh, one request each: the service's re-bake changes environments only. */
function BakeAgain({ name, bakes }) {
    const { api, announce } = use_app();
    const [problem, set_problem] = useState(null);
    const again = async () => {
        try {
            for (const bake of bakes) {
                const request = request_by_names(await api.json(`/v1/bakes/${bake.id}`));
                const newest = fields_with(bake, name).map(field => [field, `name:${name.path}@${name.version}`]);
                await api.post('/v1/bakes', { ...request, ...Object.fromEntries(newest) });
            }
            announce(`${count_text(bakes.length, 'bake')} queued.`);
            location.hash = '#/bakes';
        } catch (failure) {
            set_problem(failure);
        }
    };
    return html`<button onClick=${again}>Bake ${count_text(bakes.length, 'bake')} with version ${name.version}
        </button><${ProblemNote} problem=${problem} />`;
}

function Followers({ kind, name }) {
    const models = use_inputs('model');
    const environments = use_inputs('environment');
    const { items, more, problem } = use_list(`/v1/bakes?name=${encodeURIComponent(name.path)}`, 'bakes');
    const bakes = useMemo(() => (items ?? []).filter(bake => fields_with(bake, name).length > 0), [items]);
    const old = bakes.filter(bake => fields_with(bake, name).some(field => bake.names[field].version < name.version));
    if (problem) return html`<${ProblemNote} problem=${problem} />`;
    if (!items) return html`<${Loading} what="the bakes" />`;
    const outdated = old.filter(bake => bake.model);
    // Where the list is cut off, the service finds the bakes by the name; those of the newest version are done already.
    const again = more ? { name: name.path } : { bakes: outdated.map(({ id }) => id) };
    return html`<div>
        <p id="followers">
            ${more && 'At least '}${count_text(bakes.length, 'bake')}
            ${bakes.length === 1 ? ' uses' : ' use'} this name, ${old.length} of them in an older version.</p>
        ${
            kind === 'environment' &&
            outdated.length > 0 &&
            html`<${Rebake} label="Bake with the newest version:"
            request=${{ environment: `name:${name.path}`, ...again }} />`
        }
        ${kind !== 'environment' && old.length > 0 && html`<${BakeAgain} name=${name} bakes=${old} />`}
        ${bakes.length > 0 && html`<${BakeTable} bakes=${bakes} models=${models} environments=${environments} />`}
        <${Cut} more=${more} />
    </div>`;
}

function OneName({ kind, path, inputs }) {
    const { value: name, problem, reload } = use_json(name_address(kind, path));
    if (!name) return problem ? html`<${ProblemNote} problem=${problem} />` : html`<${Loading} what="the name" />`;
    return html`<div>
        <p>A request refers to it as <code>"${fields[kind][0]}": "name:${name.path}"</code>,
            or for one version as <code>name:${name.path}@${name.version}</code>.</p>
        <h2>New version</h2>
        ${
            kind === 'mesh'
                ? html`<p><a href="#/meshes">Send the new mesh</a> and give it this name.</p>`
                : html`<${NewVersion} key=${name.version} kind=${kind} name=${name} inputs=${inputs}
                    on_change=${reload} />`
        }
        <h2>Versions</h2>
        <${Versions} versions=${name.versions} inputs=${inputs} />
        <h2>Bakes that use it</h2>
        <${Followers} key=${name.version} kind=${kind} name=${name} />
    </div>`;
}

function NameOfInput({ kind, path }) {
    return html`<${OneName} kind=${kind} path=${path} inputs=${use_inputs(kind)} />`;
}

export default function NamePage({ path }) {
    const [, kind, ...rest] = path;
    const name = rest.join('/');
    if (name && kind === 'mesh')
        return html`<${OneName} kind="mesh" path=${name} inputs=${{ files: file_names() }} />`;
    if (name && Object.hasOwn(fields, kind)) return html`<${NameOfInput} kind=${kind} path=${name} />`;
    return html`<p>Names are listed with the <a href="#/environments">environments</a>, <a
        href="#/models">models</a> and <a href="#/meshes">meshes</a> that they point at.</p>`;
}
