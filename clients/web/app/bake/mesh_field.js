// A mesh of the request: one that has a name in the service, or an OBJ file that is sent now.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { use_app, use_list } from '../hooks.js';
import { short_digest, title_words } from '../words.js';

/** value: 'sha256:...', 'name:...' or null. */
export function MeshField({ name, schema, value, on_change, fault }) {
    const { uploads } = use_app();
    const { items } = use_list('/v1/names/mesh', 'names');
    const [, redraw] = useState(0);
    const [file, set_file] = useState(null);
    useEffect(() => uploads.listen(() => redraw(n => n + 1)), []);
    const job = file && uploads.jobs.find(one => one.file === file);
    useEffect(() => {
        if (job?.phase === 'stored') on_change(`sha256:${job.sha256}`);
    }, [job?.phase]);
    const pick = event => {
        set_file(event.target.files[0]);
        uploads.add('mesh', event.target.files);
    };
    const id = `field-${name}`;
    const known = (items ?? []).map(({ path }) => `name:${path}`);
    return html`<div class="field"><label for=${id}>${title_words(name)}</label>
        <select id=${id} aria-describedby=${`${id}-help`} onChange=${event => on_change(event.target.value || null)}>
            <option value="" selected=${!value}>none</option>
            ${value && !known.includes(value) && html`<option value=${value} selected>
                ${file?.name ?? short_digest(value)}</option>`}
            ${known.map(one => html`<option key=${one} value=${one} selected=${one === value}>${one.slice(5)}
                </option>`)}
        </select>
        <input type="file" accept=".obj" aria-label=${`Send an OBJ file as ${name}`} onChange=${pick} />
        ${job && job.phase !== 'stored' && html`<small role="status">
            ${job.file.name}: ${job.phase}${job.problem ? `: ${job.problem}` : ''}</small>`}
        <small id=${`${id}-help`}>${schema.description}</small>
        ${fault && html`<small class="problem">${fault}</small>`}
    </div>`;
}
