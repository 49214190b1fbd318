// A button that asks for a bake, follows it, and links to it when it is done.
import { html, useEffect, useState } from '../vendor/preact.js';

const pause_ms = 700;
const ended = ['done', 'failed', 'cancelled'];

/**
 * `request` gives the request when the button is pressed; it may throw in words. `old` is the bake shown now.
 * `on_asked` is told the new one's id.
 */
export function BakeOrder({ api, request, old, label, disabled = false, on_asked = () => {} }) {
    const [bake, set_bake] = useState(null);
    const [problem, set_problem] = useState('');
    const [lost, set_lost] = useState(null); // why the last answer did not come
    const ask = async () => {
        set_problem('');
        set_bake(null);
        set_lost(null);
        try {
            const view = await api.post('/v1/bakes', request());
            on_asked(view.id);
            set_bake(view);
        } catch (error) {
            set_problem(`It was not baked: ${error.message}`);
        }
    };
    const take = view => {
        set_lost(null);
        set_bake(view);
    };
    const fail = error => {
        if (!is_refusal(error)) return set_lost(error);
        set_bake(null);
        set_problem(`The new bake can be followed no longer: ${error.message}`);
    };
    useEffect(() => follow(api, bake, take, fail), [bake, lost]);
    const waits = bake !== null && !ended.includes(bake.state);
    return html`<div>
        <button type="button" disabled=${disabled || waits} aria-busy=${waits ? 'true' : 'false'} onClick=${ask}>
            ${label}
        </button>
        <p role="status" class="viewer-note">
            ${problem || html`<${Progress} bake=${bake} old=${old} />`}
            ${lost && ` ${lost.message} It is asked again.`}
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

// Asking again changes nothing; 408 and 429 are a proxy's haste.
function is_refusal({ status }) {
    return status >= 400 && status < 500 && status !== 408 && status !== 429;
}

// Asks again after a pause while the bake is on its way. Returns what stops it.
function follow(api, bake, take, fail) {
    if (!bake || ended.includes(bake.state)) return;
    const abort = new AbortController();
    const timer = setTimeout(
        () =>
            api.json(`/v1/bakes/${bake.id}`, { signal: abort.signal }).then(
                view => abort.signal.aborted || take(view),
                error => abort.signal.aborted || fail(error),
            ),
        pause_ms,
    );
    return () => {
        abort.abort();
        clearTimeout(timer);
    };
}
