// The button that cancels a bake which has not ended.
import { html, useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { ProblemNote } from '../parts.js';
import { has_ended } from './live_bake.js';

/** label: the bake's name in the button's label; on_change(view): called with the cancelled bake. */
export function CancelButton({ bake, label, on_change }) {
    const { api, announce } = use_app();
    const [problem, set_problem] = useState(null);
    if (has_ended(bake)) return null;
    const cancel = async () => {
        try {
            const view = await api.remove(`/v1/bakes/${bake.id}`);
            announce('The bake is cancelled.');
            on_change?.(view);
        } catch (failure) {
            set_problem(failure);
        }
    };
    return html`<button class="small secondary outline" onClick=${cancel}
        aria-label=${`Cancel ${label}`}>Cancel</button>
        <${ProblemNote} problem=${problem} />`;
}
