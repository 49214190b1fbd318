// A button that asks for a bake, follows it, and links to it when it is done.
import { html, useEffect, useState } from '../vendor/preact.js';

const pause_ms = 700;

/** `request` gives the request when the button is pressed; it may throw in words. `old` is the bake shown now. */
export function BakeOrder({ api, request, old, label, disabled = false }) {
    const [bake, set_bake] = useState(null);
    const [problem, set_problem] = useState('');
    const ask = async () => {
        set_problem('');
        set_bake(null);
        try {
            set_bake(await api.post('/v1/bakes', request()));
        } catch (error) {
            set_problem(error.message);
        }
    };
    useEffect(() => follow(api, bake, set_bake, set_problem), [bake]);
    const waits = bake && ['queued', 'running'].includes(bake.state);
    return html`<div>
        <button type="button" disabled=${disabled || waits} aria-busy=${waits ? 'true' : 'false'} onClick=${ask}>
            ${label}
        </button>
        <p role="status" class="viewer-note">
            ${problem ? `It was not baked: ${problem}` : html`<${Progress} bake=${bake} old=${old} />`}
        </p>
    </div>`;
}

function Progress({ bake, old }) {
    if (!bake) return null;
    if (bake.state !== 'done')
        return `The new bake is ${bake.state}${bake.error ? `: ${bake.error.message ?? ''}` : ''}.`;
    return html`Baked: <a href=${`#/view/${bake.id}`}>open the new bake</a>
        ${old && old !== bake.id && html` or <a href=${`#/view/${old}/${bake.id}`}>compare it with this one</a>`}.`;
}

// Asks again after a pause while the bake is on its way. Returns what stops it.
function follow(api, bake, set_bake, set_problem) {
    if (!bake || !['queued', 'running'].includes(bake.state)) return;
    let stopped = false;
    const timer = setTimeout(async () => {
        try {
            const view = await api.json(`/v1/bakes/${bake.id}`);
            if (!stopped) set_bake(view);
        } catch (error) {
            if (!stopped) set_problem(error.message);
        }
    }, pause_ms);
    return () => {
        stopped = true;
        clearTimeout(timer);
    };
}
