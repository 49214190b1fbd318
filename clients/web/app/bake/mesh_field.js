// A mesh of the request: one that has a name in the service, or a mesh file that is sent now.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { use_app, use_list } from '../hooks.js';
import { short_digest, title_text } from '../name_text.js';
import { Cut } from '../parts.js';

/**
 * The upload of one picked mesh.
 * on_stored(digest): called when the service has it;
 * on_wait(message): why it is not stored yet; null once it is stored or given up.
 * Returns { file, job, pick(file), drop() }; job: of uploads.js, undefined without an unfinished upload.
 */
function use_mesh_upload(on_stored, on_wait) {
    const { uploads } = use_app();
    const [, redraw] = useState(0);
    const [file, set_file] = useState(null);
    useEffect(() => uploads.listen(() => redraw(n => n + 1)), []);
    const job = file && uploads.jobs.find(one => one.file === file);
    const unfinished = job && job.phase !== 'stored' ? job : undefined;
    useEffect(() => {
        if (!job) return;
        if (unfinished) return on_wait(`${file.name} ${job.phase === 'failed' ? 'was not' : 'is still being'} sent.`);
        on_stored(job.sha256);
        on_wait(null);
    }, [job?.phase]);
    const drop = () => {
        if (unfinished) uploads.remove(job);
        set_file(null);
        on_wait(null);
    };
    const pick = picked => {
        drop();
        if (!picked) return;
        set_file(picked);
        on_wait(`${picked.name} is still being sent.`);
        uploads.add('mesh', [picked]);
    };
    return { file, job: unfinished, pick, drop };
}

function UnfinishedUpload({ job, on_cancel }) {
    const { uploads } = use_app();
    const reason = job.problem ?? job.waits;
    return html`<small role="status">${job.file.name}: ${job.phase}${reason ? `: ${reason}` : ''}</small>
        <p class="actions">
            ${job.phase === 'failed' && html`<button type="button" class="small"
                onClick=${() => uploads.again(job)}>Resume</button>`}
            <button type="button" class="small secondary outline" onClick=${on_cancel}
                aria-label=${`Cancel: ${job.file.name}`}>Cancel</button></p>`;
}

function NamedMeshes({ id, names, value, file, described, fault, on_change }) {
    return html`<select id=${id} aria-describedby=${described} aria-invalid=${fault ? 'true' : null}
        onChange=${event => on_change(event.target.value || null)}>
        <option value="" selected=${!value}>none</option>
        ${value && !names.includes(value) && html`<option value=${value} selected>
            ${file?.name ?? short_digest(value.replace('sha256:', ''))}</option>`}
        ${names.map(one => html`<option key=${one} value=${one} selected=${one === value}>${one.slice(5)}
            </option>`)}
    </select>`;
}

/**
 * name: 'occluder' or 'receiver'; schema: of that field;
 * value: 'sha256:...', 'name:...' or null; on_change(value);
 * on_wait(message): why a picked file is not yet the value; null once it is;
 * fault: what is wrong, if anything is.
 */
export function MeshField({ name, schema, value, on_change, on_wait, fault }) {
    const { items, more } = use_list('/v1/names/mesh', 'names');
    const { file, job, pick, drop } = use_mesh_upload(digest => on_change(`sha256:${digest}`), on_wait);
    const pick_first = event => {
        const [picked] = event.target.files;
        event.target.value = ''; // so that the same file can be picked again
        pick(picked);
    };
    const choose = chosen => {
        drop();
        on_change(chosen);
    };
    const id = `field-${name}`;
    const described = `${id}-help${fault ? ` ${id}-fault` : ''}`;
    const names = (items ?? []).map(({ path }) => `name:${path}`);
    return html`<div class="field"><label for=${id}>${title_text(name)}</label>
        <${NamedMeshes} ...${{ id, names, value, file, described, fault }} on_change=${choose} />
        <input type="file" accept=".obj,.ply,.glb,.gltf" aria-label=${`Send a mesh file as ${name}`} onChange=${pick_first} />
        ${job && html`<${UnfinishedUpload} job=${job} on_cancel=${drop} />`}
        <small id=${`${id}-help`}>${schema.description}</small>
        <${Cut} more=${more} />
        ${fault && html`<small class="problem" id=${`${id}-fault`}>${fault}</small>`}
    </div>`;
}
