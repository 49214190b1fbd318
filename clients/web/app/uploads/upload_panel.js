// The panel where files are dropped or picked, with the progress of each upload.
import { html, useEffect, useRef, useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { bytes_text } from '../number_text.js';

function use_jobs(kind) {
    const { uploads } = use_app();
    const [, redraw] = useState(0);
    useEffect(() => uploads.listen(() => redraw(n => n + 1)), []);
    return uploads.jobs.filter(job => job.kind === kind);
}

const phase_texts = {
    waiting: () => 'waits for the files before it',
    digesting: () => 'computing its digest, to see whether the service has the file',
    sending: job => `${bytes_text(job.done)} of ${bytes_text(job.file.size)} sent`,
    reading: () => 'the service reads it',
    stored: job => (job.known ? 'the service had it already: nothing was sent' : 'stored'),
    failed: job => job.problem,
};

function Job({ job }) {
    const { uploads } = use_app();
    const share = job.file.size ? job.done / job.file.size : 0;
    const moving = job.phase === 'digesting' || job.phase === 'sending';
    return html`<li class="job" data-phase=${job.phase}>
        <strong>${job.file.name}</strong>
        <span role=${job.phase === 'failed' ? 'alert' : null} class=${job.phase === 'failed' ? 'problem' : ''}>
            ${phase_texts[job.phase](job)}
        </span>
        ${job.waits && html`<span class="waits">The request is repeated: ${job.waits}</span>`}
        ${moving && html`<progress value=${share} max="1" aria-label=${`${job.file.name}, ${job.phase}`}></progress>`}
        <span class="actions">
            ${job.phase === 'failed' && html`<button class="small" onClick=${() => uploads.again(job)}>Resume</button>`}
            <button class="small secondary outline" onClick=${() => uploads.remove(job)}
                aria-label=${`${job.phase === 'stored' ? 'Remove from the list' : 'Cancel'}: ${job.file.name}`}>
                ${job.phase === 'stored' ? 'Hide' : 'Cancel'}
            </button>
        </span>
    </li>`;
}

/** on_stored(): called after each upload of the kind that has finished. */
export function UploadPanel({ kind, label, accept, on_stored }) {
    const { uploads } = use_app();
    const jobs = use_jobs(kind);
    const [over, set_over] = useState(false);
    const input = useRef(null);
    const stored = jobs
        .filter(({ phase }) => phase === 'stored')
        .map(({ id }) => id)
        .join(' ');
    useEffect(() => {
        if (stored) on_stored();
    }, [stored]);
    const drop = event => {
        event.preventDefault();
        set_over(false);
        uploads.add(kind, event.dataTransfer.files);
    };
    const drag = event => {
        event.preventDefault();
        set_over(true);
    };
    const pick = () => {
        uploads.add(kind, input.current.files);
        input.current.value = ''; // so that the same file can be picked again
    };
    return html`<section class=${`drop-zone ${over ? 'over' : ''}`} aria-label="Send files"
        onDrop=${drop} onDragOver=${drag} onDragEnter=${drag} onDragLeave=${() => set_over(false)}>
        <label>${label}
            <input type="file" multiple accept=${accept} ref=${input} onChange=${pick} />
        </label>
        ${jobs.length > 0 && html`<ul class="jobs">${jobs.map(job => html`<${Job} key=${job.id} job=${job} />`)}</ul>`}
    </section>`;
}
