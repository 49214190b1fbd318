// The progress of one bake: its state, its stages with their phases, the time left. Buttons cancel it and bake again.
import { html, useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { count_text } from '../number_text.js';
import { ProblemNote, State } from '../parts.js';
import { duration_text } from '../time_text.js';
import { CancelButton } from './cancel_button.js';
import { has_ended } from './live_bake.js';
import { in_new_places } from './request_fields.js';
import { phase_text, stage_title } from './stage_text.js';

function StageProgress({ stage }) {
    const percent = Math.round(100 * stage.fraction);
    const tries = stage.attempts > 1 ? `, started ${count_text(stage.attempts, 'time')}` : '';
    const title = stage_title(stage.kind);
    return html`<div class="stage-progress">
        <p><strong>${title}</strong>: ${phase_text(stage)}, ${percent} %${tries}</p>
        <progress value=${stage.fraction} max="1" aria-label=${title}></progress>
    </div>`;
}

/** Posts the same request again, after a failure or a cancel. */
function AgainButton({ bake, on_change }) {
    const { api } = use_app();
    const [problem, set_problem] = useState(null);
    const again = () =>
        api
            .post('/v1/bakes', { ...in_new_places(bake.request), priority: bake.priority })
            .then(on_change, set_problem);
    return html`<p><button class="small" onClick=${again}>Bake again</button></p><${ProblemNote} problem=${problem} />`;
}

/** bake: the service's view of it; on_change(): called when the bake was cancelled or posted again. */
export function BakeProgress({ bake, on_change }) {
    const left = bake.seconds_left ? `about ${duration_text(bake.seconds_left)} left` : '';
    return html`<section aria-label="Progress">
        <p><${State} state=${bake.state} /> ${!has_ended(bake) && html`<span>
            ${Math.round(100 * bake.fraction)} % ${left}</span>`}</p>
        ${!has_ended(bake) && bake.stages.map(stage => html`<${StageProgress} key=${stage.key} stage=${stage} />`)}
        ${bake.state === 'queued' && !bake.stages.some(stage => stage.trouble) && html`<p>It waits for a free worker.</p>`}
        <${CancelButton} bake=${bake} label="this bake" on_change=${on_change} />
        ${
            bake.state === 'failed' &&
            html`<div role="alert" class="problem"><h2>Why it failed</h2>
            <p>${bake.error?.message ?? 'The service gives no reason.'}</p></div>`
        }
        ${(bake.state === 'failed' || bake.state === 'cancelled') && html`<${AgainButton} bake=${bake}
            on_change=${on_change} />`}
    </section>`;
}
