// The picture of the hair with its captions, its status and its error message.
import { html } from '../vendor/preact.js';
import { BakeOrder } from './bake_order.js';
import { is_edited } from './lighting_edit.js';

export const hint_id = 'viewer-hint'; // of the element that says how the camera moves

const part_captions = { all: '', diffuse: ', diffuse', specular: ', specular', transmittance: ', A' };

function caption(side, names, edited) {
    const edit = !edited ? '' : side.as_baked ? ', as baked' : ', edited';
    const without = side.with_transmittance || side.part === 'transmittance' ? '' : ', without A';
    return names[side.bake] + part_captions[side.part] + edit + without;
}

function ViewerProblem({ problem, api }) {
    return html`<div class="viewer-problem" role="alert">
        <p>${problem.message}</p>
        ${
            problem.request &&
            html`<${BakeOrder} api=${api} label='Bake it with "raw"' request=${() => problem.request} />`
        }
    </div>`;
}

/** viewer: of use_viewer; names: what to call each bake. */
export function Picture({ viewer, names, api }) {
    const { canvas, stage, bakes, sides, edit, status, problem } = viewer;
    const ready = bakes.length > 0;
    return html`<div class="viewer-stage" ref=${stage}>
        <canvas ref=${canvas} tabindex="0" role="application" aria-label="Picture of the hair"
            aria-describedby=${hint_id}>
        </canvas>
        ${ready && sides.length > 1 && html`<span class="viewer-divider"></span>`}
        ${ready && html`<div class="viewer-captions">${sides.map(
            side => html`<span>${caption(side, names, is_edited(edit))}</span>`,
        )}</div>`}
        <p class="viewer-status" role="status">${status}</p>
        ${problem && html`<${ViewerProblem} problem=${problem} api=${api} />`}
    </div>`;
}
