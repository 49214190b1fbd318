// State of the viewer: the bakes shown, how they are shown, and the edit of their lighting.
import { useEffect, useRef, useState } from '../vendor/preact.js';
import { load_bake } from './bake_files.js';
import { EditOrders, arrange } from './edit_orders.js';
import { default_look, default_side } from './hair_view.js';
import { no_edit } from './lighting_edit.js';
import { use_hair_view } from './mounted_view.js';

/**
 * left, right: ids of bakes, right may be missing. With other ids, camera, look and edit stay. Shared strands and
 * maps are not fetched again.
 * Returns the state of use_hair_view, { bakes, status, sides, look, edit, orders, stops, way } and a set_ function for
 * each of the last but `orders`. orders: EditOrders; stops: screen brightness; way: how hair blocks added lights.
 */
export function use_viewer({ left, right, api }) {
    const hair_view = use_hair_view();
    const { view, set_problem } = hair_view;
    const [bakes, set_bakes] = useState([]);
    const [status, set_status] = useState('');
    const settings = use_view_settings();
    const latest = useRef(null); // for callbacks that outlive the render that made them
    latest.current = settings;
    const show = loaded => {
        const { sides, edit, orders } = latest.current;
        const shown = arrange(loaded, sides[0], edit, orders);
        view.current.set_bakes(loaded);
        view.current.set_sides(shown.sides);
        view.current.set_lighting(shown.edit);
        settings.set_sides(shown.sides);
        settings.set_edit(shown.edit);
        set_bakes(loaded);
        if (!bakes.some(({ strands }) => strands === loaded[0].strands)) view.current.frame_hair();
        if (!bakes.some(({ id }) => id === loaded[0].id)) settings.set_stops(view.current.automatic_stops());
    };
    useEffect(() => {
        const abort = new AbortController();
        if (view.current)
            load_all([left, right].filter(Boolean), api, bakes, abort.signal, { set_status, set_problem, show });
        return () => abort.abort();
    }, [left, right]);
    use_settings_in(view, settings);
    return { ...hair_view, ...settings, bakes, status };
}

function use_view_settings() {
    const [sides, set_sides] = useState([default_side]);
    const [look, set_look] = useState(default_look);
    const [edit, set_edit] = useState(no_edit());
    const [stops, set_stops] = useState(0);
    const [way, set_way] = useState('automatic');
    const [orders] = useState(() => new EditOrders());
    return { sides, set_sides, look, set_look, edit, set_edit, stops, set_stops, way, set_way, orders };
}

/** Hands each change of a setting to the view. */
function use_settings_in(view, { sides, way, look, edit, stops }) {
    useEffect(() => view.current?.set_sides(sides.map(side => ({ ...side, hidden_by: way }))), [sides, way]);
    useEffect(() => view.current?.set_look(look), [look]);
    useEffect(() => view.current?.set_lighting(edit), [edit]);
    useEffect(() => view.current?.set_display_stops(stops), [stops]);
}

/** before: bakes whose strands and maps may be used again; set_status(text), set_problem(error), show(bakes). */
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
