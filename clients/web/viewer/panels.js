// The panels beside the picture, in their order.
import { request_by_names } from '../app/bake/by_names.js';
import { html } from '../vendor/preact.js';
import { BakeOrder } from './bake_order.js';
import { HairPanel, LightsPanel, SidesPanel, SkyPanel } from './controls.js';
import { Slider } from './fields.js';
import { most_stops } from './hair_view.js';
import { compose_request, is_edited, no_edit } from './lighting_edit.js';
import { hint_id } from './picture.js';
import { save_screenshot } from './screenshot.js';

const hint = 'Drag or arrow keys: orbit. Shift with either: move. Wheel, pinch, plus and minus: distance. F: frame.';

/** The bake that an edit starts from: that of the left side. */
const edited_bake = ({ bakes, sides }) => bakes[sides[0].bake];

/** The ways in which the hair can block an added light, with the bakes shown. */
function ways_of(bakes) {
    const harmonics = bakes.some(bake => bake.strands.sh_bands > 0);
    const cone = bakes.some(bake => bake.strands.has_cone);
    return ['automatic', ...(harmonics ? ['harmonics'] : []), ...(cone ? ['cone'] : []), 'average'];
}

function ViewButtons({ viewer, ready }) {
    const { view, canvas } = viewer;
    return html`<div class="viewer-buttons">
        <button type="button" disabled=${!ready} onClick=${() => view.current.frame_hair()}>Frame</button>
        <button type="button" disabled=${!ready}
            onClick=${() => save_screenshot(view.current, canvas.current, edited_bake(viewer).id)}>
            Screenshot
        </button>
    </div>`;
}

function OrderPanel({ viewer, api }) {
    const { edit, set_edit, orders } = viewer;
    const bake = edited_bake(viewer);
    const { edit_number } = orders; // at the time of the order, not of its answer
    return html`<fieldset>
        <legend>Bake this lighting</legend>
        <${BakeOrder} api=${api} old=${bake.id} label="Bake this lighting" disabled=${!is_edited(edit)}
            request=${() => compose_request(request_by_names(bake), edit)}
            on_posted=${id => orders.add(id, edit_number, bake.id)} />
        <button type="button" class="secondary" disabled=${!is_edited(edit)}
            onClick=${() => set_edit(no_edit())}>
            Undo the edit
        </button>
    </fieldset>`;
}

function ScreenPanel({ view, stops, set_stops }) {
    return html`<fieldset>
        <legend>Screen</legend>
        <${Slider} label="Brightness of the picture alone" value=${stops} min=${-most_stops}
            max=${most_stops} step="0.1" unit="stops" on=${set_stops} />
        <button type="button" class="secondary"
            onClick=${() => set_stops(view.current.automatic_stops())}>
            Automatic
        </button>
    </fieldset>`;
}

/** Panels that need a bake. */
function BakePanels({ viewer, names, api }) {
    const { bakes, sides, set_sides, look, set_look, edit, set_edit, way, set_way } = viewer;
    const { maps } = edited_bake(viewer);
    return html`<${SidesPanel} sides=${sides} names=${names} is_edited=${is_edited(edit)} on=${set_sides} />
        <${SkyPanel} edit=${edit} on=${set_edit} />
        <${LightsPanel} lights=${edit.lights} level=${maps.level} way=${way} ways=${ways_of(bakes)} on_way=${set_way}
            on=${lights => set_edit({ ...edit, lights })} />
        <${OrderPanel} viewer=${viewer} api=${api} />
        <${HairPanel} look=${look} exponent=${maps.exponent} on=${set_look} />
        <${ScreenPanel} ...${viewer} />`;
}

/** viewer: of use_viewer; names: what to call each bake. */
export function Panels({ viewer, names, api }) {
    const { bakes, frame_ms } = viewer;
    const ready = bakes.length > 0;
    return html`<form class="viewer-panels" onSubmit=${event => event.preventDefault()}>
        <p id=${hint_id} class="viewer-note">${hint}</p>
        <${ViewButtons} viewer=${viewer} ready=${ready} />
        <p class="viewer-note">
            Frame time: <output>${frame_ms === null ? '–' : `${frame_ms.toFixed(1)} ms`}</output>
        </p>
        ${ready && html`<${BakePanels} viewer=${viewer} names=${names} api=${api} />`}
    </form>`;
}
