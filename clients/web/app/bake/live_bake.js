// A bake as it goes: state, stages, time left, cancel.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { use_app, use_watch } from '../hooks.js';
import { ProblemNote, State } from '../parts.js';
import { title_text } from '../name_text.js';
import { count_text } from '../number_text.js';
import { duration_text } from '../time_text.js';

export const has_ended = ({ state }) => state === 'done' || state === 'failed' || state === 'cancelled';
export const watch_ms = 700;

const stage_words = { transmittance: 'Transmittance', irradiance: 'Irradiance maps' };

function phase_words(stage) {
    if (stage.state === 'done') return 'done';
    if (stage.state !== 'running') return stage.state;
    return stage.phase ? title_text(stage.phase) : 'starting';
}

function Stage({ stage }) {
    const percent = Math.round(100 * stage.fraction);
    const tries = stage.attempts > 1 ? `, started ${count_text(stage.attempts, 'time')}` : '';
    return html`<div class="stage-progress">
        <p><strong>${stage_words[stage.kind] ?? stage.kind}</strong>: ${phase_words(stage)}, ${percent} %${tries}</p>
        <progress value=${stage.fraction} max="1" aria-label=${`${stage_words[stage.kind] ?? stage.kind}`}></progress>
    </div>`;
}

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

/** The same request again, after a failure or a cancel. */
function AgainButton({ bake, on_change }) {
    const { api } = use_app();
    const [problem, set_problem] = useState(null);
    const again = () =>
        api.post('/v1/bakes', { ...bake.request, priority: bake.priority }).then(on_change, set_problem);
    return html`<p><button class="small" onClick=${again}>Bake again</button></p><${ProblemNote} problem=${problem} />`;
}

/** { bake, problem, again() }: watched until it has ended; again() starts watching anew. */
export function use_bake(id) {
    const { announce } = use_app();
    const [round, set_round] = useState(0);
    const { value: bake, problem } = use_watch(`/v1/bakes/${id}`, watch_ms, has_ended, round);
    useEffect(() => {
        if (bake) announce(`The bake is ${bake.state}.`);
    }, [bake?.state]);
    return { bake, problem, again: () => set_round(n => n + 1) };
}

export function Progress({ bake, again }) {
    const left = bake.seconds_left ? `about ${duration_text(bake.seconds_left)} left` : '';
    return html`<section aria-label="Progress">
        <p><${State} state=${bake.state} /> ${!has_ended(bake) && html`<span>
            ${Math.round(100 * bake.fraction)} % ${left}</span>`}</p>
        ${!has_ended(bake) && bake.stages.map(stage => html`<${Stage} key=${stage.key} stage=${stage} />`)}
        ${bake.state === 'queued' && html`<p>It waits for a free worker.</p>`}
        <${CancelButton} bake=${bake} label="this bake" on_change=${again} />
        ${
            bake.state === 'failed' &&
            html`<div role="alert" class="problem"><h2>Why it failed</h2>
            <p>${bake.error?.message ?? 'The service gives no reason.'}</p></div>`
        }
        ${(bake.state === 'failed' || bake.state === 'cancelled') && html`<${AgainButton} bake=${bake}
            on_change=${again} />`}
    </section>`;
}
