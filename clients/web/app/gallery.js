// The gallery of stored hair models or environments, with the upload panel above it.
import { html, useMemo, useState } from '../vendor/preact.js';
import { delete_input } from './deletion.js';
import { use_app, use_list } from './hooks.js';
import { fact_rows, label_of, names_by_digest, summary, versions_by_path, warnings } from './input_facts.js';
import { Cut, Facts, Loading, ProblemNote, Warnings } from './parts.js';
import { file_names } from './uploads/uploads.js';
import { UploadPanel } from './uploads/upload_panel.js';
import { name_from_file } from './name_text.js';

/**
 * The stored inputs of a kind and their names. Returns { items, more, names: { sha256: [path] },
 * versions: { path: version }, files: { sha256: file name }, problem, reload() }.
 */
export function use_inputs(kind) {
    const list = use_list(`/v1/${kind}s`, `${kind}s`);
    const named = use_list(`/v1/names/${kind}`, 'names');
    const reload = () => {
        list.reload();
        named.reload();
    };
    const names = useMemo(() => names_by_digest(named.items ?? []), [named.items]);
    const versions = useMemo(() => versions_by_path(named.items ?? []), [named.items]);
    const files = useMemo(file_names, [list.items]);
    const more = list.more || named.more;
    return { items: list.items, more, names, versions, files, problem: list.problem ?? named.problem, reload };
}

/** Points a name at a file. entry: { kind, id }, id is the file's digest; suggestion: the name that is filled in. */
export function NameForm({ entry, suggestion, on_named }) {
    const { api, announce } = use_app();
    const [problem, set_problem] = useState(null);
    const save = async event => {
        event.preventDefault();
        const form = new FormData(event.target);
        const path = form.get('path').trim();
        try {
            const { version } = await api.put(name_address(entry.kind, path), {
                sha256: entry.id,
                note: form.get('note'),
            });
            announce(`${path} is now version ${version}.`);
            on_named();
        } catch (failure) {
            set_problem(failure);
        }
    };
    return html`<form onSubmit=${save}>
        <label>Name
            <input name="path" required maxlength="200" pattern="[A-Za-z0-9._\\-]+(/[A-Za-z0-9._\\-]+)*"
                value=${suggestion}
                aria-describedby=${`help-${entry.id}`} />
            <small id=${`help-${entry.id}`}>Letters, digits, ".", "_", "-", and "/" between parts.
                A name that exists gets a new version.</small>
        </label>
        <label>Note <input name="note" maxlength="500" /></label>
        <${ProblemNote} problem=${problem} />
        <button type="submit" class="small">Give this name</button>
    </form>`;
}

export const name_address = (kind, path) => `/v1/names/${kind}/${path.split('/').map(encodeURIComponent).join('/')}`;

function Names({ kind, paths }) {
    if (!paths) return null;
    return html`<p class="names">${paths.map((path, i) => html`${i > 0 && ', '}<a key=${path}
        href=${`#/names/${kind}/${path}`}>${path}</a>`)}</p>`;
}

const eager_pictures = 6; // at the top of the page; others are loaded when they are scrolled to

function Card({ entry, index, label, paths, files, on_change }) {
    const { api, announce } = use_app();
    const [problem, set_problem] = useState(null);
    const remove = async () => {
        try {
            if (!(await delete_input(api, entry.links.self, label))) return;
            announce(`${label} is deleted.`);
            on_change();
        } catch (failure) {
            set_problem(failure);
        }
    };
    const field = entry.kind === 'model' ? 'hair' : 'environment';
    const bake = `#/bake?${field}=${entry.id}`;
    return html`<article class="card" data-id=${entry.id}>
        <img src=${entry.links.thumbnail} alt="" loading=${index < eager_pictures ? null : 'lazy'} width="256"
            height=${entry.kind === 'model' ? 256 : 128} />
        <h3>${label}</h3>
        <${Names} kind=${entry.kind} paths=${paths} />
        <p>${summary(entry)}</p>
        <${Warnings} texts=${warnings(entry)} />
        <p class="actions"><a role="button" class="small" href=${bake} aria-label=${`Bake with ${label}`}>Bake</a>
            <button class="small secondary outline" onClick=${remove} aria-label=${`Delete ${label}`}>Delete</button>
                </p>
        <${ProblemNote} problem=${problem} />
        <details><summary>Facts</summary><${Facts} rows=${fact_rows(entry)} /></details>
        <details><summary>Give a name</summary>
            <${NameForm} entry=${entry} suggestion=${paths?.[0] ?? name_from_file(files[entry.id] ?? '')}
                on_named=${on_change} />
        </details>
    </article>`;
}

export function Gallery({ kind, label, accept, empty }) {
    const { items, more, names, files, problem, reload } = use_inputs(kind);
    return html`<div>
        <${UploadPanel} kind=${kind} label=${label} accept=${accept} on_stored=${reload} />
        <${ProblemNote} problem=${problem} />
        <h2 class="visually-hidden">Stored</h2>
        ${!items && html`<${Loading} what="the gallery" />`}
        ${items?.length === 0 && !problem && html`<p>${empty}</p>`}
        <div class="gallery">
            ${(items ?? []).map(
                (
                    entry,
                    index,
                ) => html`<${Card} key=${entry.id} entry=${entry} index=${index}
                    label=${label_of(entry.id, names, files)}
                paths=${names[entry.id]} files=${files} on_change=${reload} />`,
            )}
        </div>
        <${Cut} more=${more} />
    </div>`;
}
