// The page that shows hair under a bake's light while the light is edited. Its loop, its requests and its memory on the
// graphics card end when it is unmounted.
import { html } from '../vendor/preact.js';
import { lighting_text } from './lighting_edit.js';
import { Panels } from './panels.js';
import { Picture } from './picture.js';
import { use_viewer } from './viewer_state.js';

const css = new URL('viewer.css', import.meta.url).href;

/**
 * left, right: ids of the bakes, right may be missing;
 * api: an Api, whose failures are Errors with a status (0: no answer);
 * title(bake): what to call a bake.
 */
export function ViewerPage({ left, right, api, title = bake => bake.id.slice(0, 8) }) {
    const viewer = use_viewer({ left, right, api });
    const names = viewer.bakes.map(bake =>
        [title(bake), `${bake.maps.count - 1} specular maps`, ...lighting_text(bake.request)].join(', '),
    );
    return html`<link rel="stylesheet" href=${css} />
        <section class="viewer" aria-label="Viewer">
            <${Picture} viewer=${viewer} names=${names} api=${api} />
            <${Panels} viewer=${viewer} names=${names} api=${api} />
        </section>`;
}
