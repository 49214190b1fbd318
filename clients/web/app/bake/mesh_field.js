// A mesh of the request: one that has a name in the service, or an OBJ file that is sent now.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { use_app, use_list } from '../hooks.js';
import { Cut } from '../parts.js';
import { short_digest, title_text } from '../name_text.js';

const words_after = words => (words ? `: ${words}` : '');

/** value: 'sha256:...', 'name:...' or null; on_wait(words): why a picked file is not the value yet, null once it is. */
export function MeshField({ name, schema, value, on_change, on_wait, fault }) {
    const { uploads } = use_app();
    const { items, more } = use_list('/v1/names/mesh', 'names');
    const [, redraw] = useState(0);
    const [file, set_file] = useState(null);
    useEffect(() => uploads.listen(() => redraw(n => n + 1)), []);
    const job = file && uploads.jobs.find(one => one.file === file);
    const waits = job && job.phase !== 'stored';
    useEffect(() => {
        if (!job) return;
        if (waits) on_wait(`${file.name} ${job.phase === 'failed' ? 'was not' : 'is still being'} sent.`);
        else {
            on_change(`sha256:${job.sha256}`);
            on_wait(null);
        }
    }, [job?.phase]);
    const drop = () => {
        if (waits) uploads.remove(job);
        set_file(null);
        on_wait(null);
    };
    const pick = event => {
        const [picked] = event.target.files;
        event.target.value = ''; // so that the same file can be picked again
        drop();
        if (!picked) return;
        set_file(picked);
        on_wait(`${picked.name} is still being sent.`);
        uploads.add('mesh', [picked]);
    };
    const choose = event => {
        drop();
        on_change(event.target.value || null);
    };
    const id = `field-${name}`;
    const described = `${id}-help${fault ? ` ${id}-fault` : ''}`;
    const known = (items ?? []).map(({ path }) => `name:${path}`);
    return html`<div class="field"><label for=${id}>${title_text(name)}</label>
        <select id=${id} aria-describedby=${described} aria-invalid=${fault ? 'true' : null} onChange=${choose}>
            <option value="" selected=${!value}>none</option>
            ${value && !known.includes(value) && html`<option value=${value} selected>
                ${file?.name ?? short_digest(value.replace('sha256:', ''))}</option>`}
            ${known.map(one => html`<option key=${one} value=${one} selected=${one === value}>${one.slice(5)}
                </option>`)}
        </select>
        <input type="file" accept=".obj" aria-label=${`Send an OBJ file as ${name}`} onChange=${pick} />
        ${waits && html`<small role="status">${job.file.name}: ${job.phase}${words_after(job.problem ?? job.waits)}
            </small>`}
        ${waits && html`<p class="actions">
            ${job.phase === 'failed' && html`<button type="button" class="small"
                onClick=${() => uploads.again(job)}>Go on</button>`}
            <button type="button" class="small secondary outline" onClick=${drop}
                aria-label=${`Cancel: ${job.file.name}`}>Cancel</button></p>`}
        <small id=${`${id}-help`}>${schema.description}</small>
        <${Cut} more=${more} />
        ${fault && html`<small class="problem" id=${`${id}-fault`}>${fault}</small>`}
    </div>`;
}
