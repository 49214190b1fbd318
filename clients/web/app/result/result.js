// The page of a finished bake: its maps, transmittance, accuracy, timings and files.
import { html } from '../../vendor/preact.js';
import { use_app, use_json } from '../hooks.js';
import { title_text } from '../name_text.js';
import { bytes_text } from '../number_text.js';
import { Facts, Loading, ProblemNote, Warnings } from '../parts.js';
import { duration_text } from '../time_text.js';
import { accuracy_rows } from './accuracy.js';
import { Downloads } from './downloads.js';
import { Histogram } from './histogram.js';
import { MapView } from './map_view.js';

function Accuracy({ manifest }) {
    const rows = accuracy_rows(manifest);
    return rows.length > 0 && html`<h2>Accuracy</h2><${Facts} rows=${rows} />`;
}

function Timings({ manifest }) {
    const rows = Object.entries(manifest.timings_s ?? {}).map(([name, seconds]) => [
        title_text(name),
        duration_text(seconds),
    ]);
    if (manifest.peak_memory_bytes) rows.push(['Peak memory', bytes_text(manifest.peak_memory_bytes)]);
    if (manifest.measured?.threads) rows.push(['Threads', String(manifest.measured.threads)]);
    return html`<h2>Time and memory</h2><${Facts} rows=${rows} />`;
}

function Previews({ bake, manifest }) {
    const { api } = use_app();
    const sheets = bake.files.filter(({ name }) => /^preview_\w+\.png$/.test(name));
    const size = name => manifest.files.find(file => file.name === name)?.shape ?? []; // rows, columns
    return html`<div class="previews">${sheets.map(
        ({ name }) => html`<details key=${name}><summary>Contact sheet: ${title_text(name.slice(8, -4))}</summary>
        <img src=${api.file_url(bake.id, name)} height=${size(name)[0]} width=${size(name)[1]}
            alt=${`Contact sheet of the ${name.slice(8, -4)}`} loading="lazy" /></details>`,
    )}</div>`;
}

const without_raw = html`<p>This bake was made without the output <code>raw</code>;
    the contact sheets below show it.</p>`;

export function Result({ bake }) {
    const { api } = use_app();
    const { value: manifest, problem } = use_json(api.file_url(bake.id, 'manifest.json'));
    const has = name => bake.files.some(file => file.name === name);
    if (!manifest)
        return problem ? html`<${ProblemNote} problem=${problem} />` : html`<${Loading} what="the result" />`;
    const contents = Object.fromEntries(manifest.files.map(({ name, content }) => [name, content]));
    return html`<div>
        <p class="actions">
            ${has('maps.f16') && has('strands.bin') && html`<a role="button"
                href=${`#/view/${bake.id}`}>See it on the hair</a>`}
            ${bake.model && html`<a role="button" class="outline"
                href=${`#/rebake?bakes=${bake.id}`}>Re-bake under another environment</a>`}
        </p>
        <${Warnings} texts=${manifest.warnings ?? []} />
        ${bake.environment && html`<h2>Irradiance maps</h2>${has('maps.f16') ? html`<${MapView}
            bake=${bake.id} />` : without_raw}`}
        ${bake.model && html`<h2>Transmittance A</h2>${has('strands.bin') ? html`<${Histogram}
            bake=${bake.id} />` : without_raw}`}
        <${Previews} bake=${bake} manifest=${manifest} />
        <${Accuracy} manifest=${manifest} />
        <${Timings} manifest=${manifest} />
        <h2>Files</h2>
        <${Downloads} files=${bake.files} contents=${contents} />
    </div>`;
}
