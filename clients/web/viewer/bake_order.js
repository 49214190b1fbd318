// A button that posts a request, watches the bake, and links to it when it is done.
import { is_turned_away } from '../app/retry.js';
import { html, useEffect, useState } from '../vendor/preact.js';

const pause_ms = 700;
const ended = ['done', 'failed', 'cancelled'];

/**
 * request(): called when the button is pressed; an Error that it throws is shown;
 * old: id of the bake shown now, if the new one can be compared with it;
 * on_posted(id): called with the id of the new bake.
 */
export function BakeOrder({ api, request, old, label, disabled = false, on_posted = () => {} }) {
    const [bake, set_bake] = useState(null);
    const [problem, set_problem] = useState('');
    const [lost, set_lost] = useState(null); // why the last answer is missing
    const post = async () => {
        set_problem('');
        set_bake(null);
        set_lost(null);
        try {
            const view = await api.post('/v1/bakes', request());
            on_posted(view.id);
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
        set_problem(`The new bake can no longer be watched: ${error.message}`);
    };
    useEffect(() => follow(api, bake, take, fail), [bake, lost]);
    const waits = bake !== null && !ended.includes(bake.state);
    return html`<div>
        <button type="button" disabled=${disabled || waits} aria-busy=${waits ? 'true' : 'false'} onClick=${post}>
            ${label}
        </button>
        <p role="status" class="viewer-note">
            ${problem || html`<${Progress} bake=${bake} old=${old} />`}
            ${lost && ` ${lost.message} The request is repeated.`}
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

// A retry would fail too.
function is_refusal({ status }) {
    return status >= 400 && status < 500 && !is_turned_away(status);
}

// Fetches the bake again after a pause unless it has ended. Returns a function that cancels the fetch.
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
