// The page that shows hair under a bake's light while the light is edited.
//
//   ViewerPage({ left, right, api }): left and right are ids of bakes (right may be missing); with others, camera, look
//   and edit stay, and what they share with those before is not fetched again;
//   words(bake) says which bake that is;
//   api is that of app/api.js: its failures are Errors in words, with the status (0: no answer).
//
// What it holds on the card, its loop and what it is fetching end when it is unmounted.
import { request_by_names } from '../app/bake/by_names.js';
import { html, useEffect, useRef, useState } from '../vendor/preact.js';
import { BakeOrder } from './bake_order.js';
import { load_bake } from './bake_files.js';
import { HairPanel, LightsPanel, SidesPanel, SkyPanel } from './controls.js';
import { Slider } from './fields.js';
import { HairView, default_look, default_side, most_stops } from './hair_view.js';
import { compose_request, is_edited, lighting_text, no_edit } from './lighting_edit.js';
import { listen_for_orbit } from './orbit_input.js';

const css = new URL('viewer.css', import.meta.url).href;
const hint = 'Drag or arrow keys: orbit. Shift with either: move. Wheel, pinch, plus and minus: distance. F: frame.';

export function ViewerPage({ left, right, api, words = bake => bake.id.slice(0, 8) }) {
    const canvas = useRef(null),
        view = useRef(null),
        stage = useRef(null);
    const [bakes, set_bakes] = useState([]);
    const [status, set_status] = useState('');
    const [problem, set_problem] = useState(null);
    const [frame_ms, set_frame_ms] = useState(null);
    const [sides, set_sides] = useState([default_side]);
    const [look, set_look] = useState(default_look);
    const [edit, set_edit] = useState(no_edit());
    const [edit_number, set_edit_number] = useState(0); // counts the edits; moving a slider goes on with the same one
    const orders = useRef(new Map()); // id of a bake that was asked for here -> { number of the edit, from: id }
    const now = useRef({});
    now.current = { sides, edit, edit_number };
    const [stops, set_stops] = useState(0);
    const [way, set_way] = useState('automatic');

    useEffect(() => mount_view(canvas.current, stage.current, view, set_frame_ms, set_problem), []);
    useEffect(() => {
        const abort = new AbortController();
        const show = loaded => {
            const { edit, edit_number } = now.current;
            const two = loaded.length > 1;
            // What an edit was baked into is not edited once more, also where the edit has gone on since. Alone it is
            // shown as baked and a new edit begins there: what was changed after the order is left behind, as it starts
            // from the old lighting. Beside the bake that it was ordered from, the edit stays, as that one's.
            const holds_edit = ({ id }) => {
                const order = orders.current.get(id);
                return Boolean(order) && (order.edit_number === edit_number || (two && order.from === loaded[0].id));
            };
            const begins_anew = !two && holds_edit(loaded[0]),
                lighting = begins_anew ? no_edit() : edit;
            const first = now.current.sides[0];
            const together = loaded.map((bake, i) => ({ ...first, bake: i, as_baked: two && holds_edit(bake) }));
            view.current.set_bakes(loaded);
            view.current.set_sides(together);
            view.current.set_lighting(lighting);
            set_sides(together);
            set_edit(lighting);
            if (begins_anew) set_edit_number(edit_number + 1);
            set_bakes(loaded);
            if (!bakes.some(({ strands }) => strands === loaded[0].strands)) view.current.frame_hair();
            if (!bakes.some(({ id }) => id === loaded[0].id)) set_stops(view.current.automatic_stops());
        };
        if (view.current)
            load_all([left, right].filter(Boolean), api, bakes, abort.signal, { set_status, set_problem, show });
        return () => abort.abort();
    }, [left, right]);
    useEffect(() => view.current?.set_sides(sides.map(side => ({ ...side, hidden_by: way }))), [sides, way]);
    useEffect(() => view.current?.set_look(look), [look]);
    useEffect(() => view.current?.set_lighting(edit), [edit]);
    useEffect(() => view.current?.set_display_stops(stops), [stops]);

    const names = bakes.map(bake =>
        [words(bake), `${bake.maps.count - 1} specular maps`, ...lighting_text(bake.request)].join(', '),
    );
    const ready = bakes.length > 0,
        edited = bakes[sides[0].bake]; // the one on the left is what an edit starts from
    return html`<link rel="stylesheet" href=${css} />
        <section class="viewer" aria-label="Viewer">
            <div class="viewer-stage" ref=${stage}>
                <canvas ref=${canvas} tabindex="0" role="application" aria-label="Picture of the hair"
                    aria-describedby="viewer-hint">
                </canvas>
                ${ready && sides.length > 1 && html`<span class="viewer-divider"></span>`}
                ${ready && html`<${Captions} sides=${sides} names=${names} is_edited=${is_edited(edit)} />`}
                <p class="viewer-status" role="status">${status}</p>
                ${problem && html`<${Problem} problem=${problem} api=${api} />`}
            </div>
            <form class="viewer-panels" onSubmit=${event => event.preventDefault()}>
                <p id="viewer-hint" class="viewer-note">${hint}</p>
                <div class="viewer-buttons">
                    <button type="button" disabled=${!ready} onClick=${() => view.current.frame_hair()}>Frame</button>
                    <button type="button" disabled=${!ready}
                        onClick=${() => save_screenshot(view.current, canvas.current, edited.id)}>
                        Screenshot
                    </button>
                </div>
                <p class="viewer-note">
                    Frame time: <output>${frame_ms === null ? '–' : `${frame_ms.toFixed(1)} ms`}</output>
                </p>
                ${
                    ready &&
                    html`
                    <${SidesPanel} sides=${sides} names=${names} is_edited=${is_edited(edit)} on=${set_sides} />
                    <${SkyPanel} edit=${edit} on=${set_edit} />
                    <${LightsPanel} lights=${edit.lights} level=${edited.maps.level} way=${way}
                        ways=${ways_of(bakes)} on_way=${set_way} on=${lights => set_edit({ ...edit, lights })} />
                    <fieldset>
                        <legend>Bake this lighting</legend>
                        <${BakeOrder} api=${api} old=${edited.id} label="Bake this lighting"
                            disabled=${!is_edited(edit)}
                            request=${() => compose_request(request_by_names(edited), edit)}
                            on_asked=${id => orders.current.set(id, { edit_number, from: edited.id })} />
                        <button type="button" class="secondary" disabled=${!is_edited(edit)}
                            onClick=${() => set_edit(no_edit())}>
                            Undo the edit
                        </button>
                    </fieldset>
                    <${HairPanel} look=${look} exponent=${edited.maps.exponent} on=${set_look} />
                    <fieldset>
                        <legend>Screen</legend>
                        <${Slider} label="Brightness of the picture alone" value=${stops} min=${-most_stops}
                            max=${most_stops} step="0.1" unit="stops" on=${set_stops} />
                        <button type="button" class="secondary"
                            onClick=${() => set_stops(view.current.automatic_stops())}>
                            Automatic
                        </button>
                    </fieldset>`
                }
            </form>
        </section>`;
}

// Makes the view and ties it to the page; returns what undoes that.
function mount_view(canvas, stage, holder, set_frame_ms, set_problem) {
    try {
        holder.current = new HairView(canvas, { drawn: set_frame_ms });
    } catch (error) {
        set_problem(new Error('This browser has no WebGL 2, which the viewer draws with.', { cause: error }));
        return;
    }
    const view = holder.current;
    const lost = () =>
        set_problem(new Error('The graphics card dropped the picture. Reloading the page draws it again.'));
    canvas.addEventListener('webglcontextlost', lost);
    const fit = () => view.resize(stage.clientWidth, stage.clientHeight, Math.min(devicePixelRatio, 2));
    const observer = new ResizeObserver(fit);
    observer.observe(stage);
    fit();
    const deaf = listen_for_orbit(
        canvas,
        view.camera,
        () => view.request_frame(),
        () => view.frame_hair(),
    );
    return () => {
        canvas.removeEventListener('webglcontextlost', lost);
        observer.disconnect();
        deaf();
        holder.current = null;
        view.dispose();
    };
}

async function load_all(ids, api, before, signal, { set_status, set_problem, show }) {
    set_problem(null);
    const bakes = [];
    try {
        for (const id of ids)
            bakes.push(await load_bake(api, id, { known: [...before, ...bakes], signal, say: set_status }));
        if (!signal.aborted) show(bakes);
    } catch (error) {
        if (!signal.aborted) set_problem(error);
    }
    if (!signal.aborted) set_status('');
}

// What can hide a light that is added, with the bakes shown.
function ways_of(bakes) {
    const harmonics = bakes.some(bake => bake.strands.sh_bands > 0),
        cone = bakes.some(bake => bake.strands.has_cone);
    return ['automatic', ...(harmonics ? ['harmonics'] : []), ...(cone ? ['cone'] : []), 'average'];
}

async function save_screenshot(view, canvas, id) {
    const picture = await view.screenshot(getComputedStyle(canvas).backgroundColor);
    const link = document.createElement('a');
    link.href = URL.createObjectURL(picture);
    link.download = `hairbake_${id.slice(0, 12)}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function Captions({ sides, names, is_edited }) {
    const parts = { all: '', diffuse: ', diffuse', specular: ', specular', transmittance: ', A' };
    const text = side =>
        names[side.bake] +
        parts[side.part] +
        (is_edited ? (side.as_baked ? ', as baked' : ', edited') : '') +
        (side.with_transmittance || side.part === 'transmittance' ? '' : ', without A');
    return html`<div class="viewer-captions">${sides.map(side => html`<span>${text(side)}</span>`)}</div>`;
}

function Problem({ problem, api }) {
    return html`<div class="viewer-problem" role="alert">
        <p>${problem.message}</p>
        ${
            problem.request &&
            html`<${BakeOrder} api=${api} label='Bake it with "raw"' request=${() => problem.request} />`
        }
    </div>`;
}
