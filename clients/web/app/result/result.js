// What a finished bake holds.
import { html } from '../../vendor/preact.js';
import { use_app, use_json } from '../hooks.js';
import { Facts, Loading, ProblemNote, Warnings } from '../parts.js';
import { title_text } from '../name_text.js';
import { bytes_text, count_text, number_text } from '../number_text.js';
import { duration_text } from '../time_text.js';
import { Downloads } from './downloads.js';
import { Histogram } from './histogram.js';
import { MapView } from './map_view.js';

const interval = ([low, high]) => `${number_text(low, 3)} to ${number_text(high, 3)}`;

function ErrorBars({ manifest }) {
    const bar = manifest.error_bar;
    const maps = manifest.irradiance;
    const rows = [];
    if (bar?.vertices === 0)
        rows.push(['A against traced strands', 'not measured: every vertex drawn lies inside another strand']);
    else if (bar)
        rows.push(
            ['A against traced strands, RMSE', `${number_text(bar.rmse, 3)} (95 %: ${interval(bar.ci95.rmse)})`],
            ['Bias', `${number_text(bar.bias, 3)} (95 %: ${interval(bar.ci95.bias)})`],
            [
                'Measured with',
                `${count_text(bar.vertices, 'vertex', 'vertices')}, ${count_text(bar.directions, 'direction')} each`,
            ],
        );
    if (maps?.interpolation_bound_relative !== undefined)
        rows.push([
            'Between specular maps, at most',
            `${number_text(100 * maps.interpolation_bound_relative, 3)} % of the largest value`,
        ]);
    if (maps?.sh)
        rows.push(
            ...Object.entries(maps.sh)
                .filter(([, value]) => typeof value === 'number')
                .map(([name, value]) => [title_text(name), number_text(value, 3)]),
        );
    if (rows.length === 0) return null;
    return html`<h2>How good it is</h2><${Facts} rows=${rows} />`;
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
        <${ErrorBars} manifest=${manifest} />
        <${Timings} manifest=${manifest} />
        <h2>Files</h2>
        <${Downloads} files=${bake.files} contents=${contents} />
    </div>`;
}
