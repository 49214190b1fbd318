// The list of bakes, newest first.
import { html, useState } from '../../vendor/preact.js';
import { BakeTable } from '../bake/bake_table.js';
import { use_inputs } from '../gallery.js';
import { use_watch } from '../hooks.js';
import { Cut, Loading, ProblemNote } from '../parts.js';
import { most_shown } from '../list_pages.js';
import { count_text } from '../number_text.js';

const states = ['queued', 'running', 'done', 'failed', 'cancelled'];
const page_size = 50;

export default function BakesPage() {
    const models = use_inputs('model');
    const environments = use_inputs('environment');
    const [state, set_state] = useState('');
    const [limit, set_limit] = useState(page_size);
    const [chosen, set_chosen] = useState(new Set());
    const [round, set_round] = useState(0);
    const { value, problem } = use_watch(
        `/v1/bakes?limit=${limit}${state && `&state=${state}`}`,
        1500,
        () => false,
        round,
    );
    const choose = (id, whether) => {
        const next = new Set(chosen);
        if (whether) next.add(id);
        else next.delete(id);
        set_chosen(next);
    };
    return html`<div>
        <div class="toolbar">
            <label>State <select onChange=${event => set_state(event.target.value)}>
                <option value="">all</option>${states.map(one => html`<option key=${one}>${one}</option>`)}
            </select></label>
            <a role="button" class="small" href="#/bake">New bake</a>
            ${chosen.size === 2 && html`<a role="button" class="small" href=${`#/view/${[...chosen].join('/')}`}>
                Compare in the viewer</a>`}
            ${chosen.size > 0 && html`<a role="button" class="small"
                href=${`#/rebake?bakes=${[...chosen].join(',')}`}>Re-bake ${count_text(chosen.size, 'bake')}</a>`}
        </div>
        <${ProblemNote} problem=${problem} />
        ${!value && !problem && html`<${Loading} what="the bakes" />`}
        ${value?.bakes.length === 0 && html`<p>There is none${state && ` that is ${state}`}.</p>`}
        ${
            value?.bakes.length > 0 &&
            html`<${BakeTable} bakes=${value.bakes} models=${models} environments=${environments} chosen=${chosen}
                on_choose=${choose}
            on_change=${() => set_round(n => n + 1)} />`
        }
        ${value?.next && limit < most_shown && html`<button class="small outline"
            onClick=${() => set_limit(Math.min(most_shown, limit + 150))}>Show more</button>`}
        <${Cut} more=${value?.next && limit === most_shown} />
    </div>`;
}
