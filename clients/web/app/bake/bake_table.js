// A table of bakes: state, model, environment, time.
import { html } from '../../vendor/preact.js';
import { use_watch } from '../hooks.js';
import { label_of } from '../input_facts.js';
import { Heads, State } from '../parts.js';
import { short_digest } from '../name_text.js';
import { duration_text, time_text } from '../time_text.js';
import { CancelButton } from './cancel_button.js';
import { has_ended, watch_ms } from './live_bake.js';

/** The progress of a running bake. */
function Running({ bake }) {
    const { value } = use_watch(`/v1/bakes/${bake.id}`, 2 * watch_ms, has_ended);
    if (!value) return null;
    return html`<progress value=${value.fraction} max="1" aria-label="Progress"></progress>
        ${value.seconds_left ? html`<small>about ${duration_text(value.seconds_left)} left</small>` : null}`;
}

/** An input of a bake: "sunset, version 2" when the bake names it, else its label. field: 'hair' or 'environment'. */
function input_title(bake, field, inputs) {
    const digest = field === 'hair' ? bake.model : bake.environment;
    if (!digest) return '–';
    const name = bake.names[field];
    return name ? `${name.path}, version ${name.version}` : label_of(digest, inputs.names, inputs.files);
}

export const bake_title = (bake, models, environments) =>
    `${input_title(bake, 'hair', models)} under ${input_title(bake, 'environment', environments)}`;

/**
 * chosen: a Set of ids, on_choose(id, is_chosen): both or neither; only bakes of a hair model can be chosen;
 * on_change(): called when a bake was cancelled.
 */
export function BakeTable({ bakes, models, environments, chosen, on_choose, on_change }) {
    return html`<div class="scroll" tabindex="0" role="region" aria-label="Bakes"><table class="striped">
        <${Heads} titles=${['Chosen', 'State', 'Model', 'Environment', 'Created', 'Bake'].slice(chosen ? 0 : 1)} />
        <tbody>${bakes.map(bake => {
            const title = bake_title(bake, models, environments);
            const short = short_digest(bake.id); // distinguishes bakes of one model and environment
            return html`<tr key=${bake.id} data-id=${bake.id}>
                ${
                    chosen &&
                    html`<td>${
                        bake.model &&
                        html`<input type="checkbox" checked=${chosen.has(bake.id)} aria-label=${`Choose ${title}`}
                    onChange=${event => on_choose(bake.id, event.target.checked)} />`
                    }</td>`
                }
                <td><${State} state=${bake.state} />${bake.state === 'running' && html`<${Running} bake=${bake} />`}
                    ${bake.error && html`<small class="problem">${bake.error.message}</small>`}</td>
                <td>${input_title(bake, 'hair', models)}</td>
                <td>${input_title(bake, 'environment', environments)}</td>
                <td>${time_text(bake.created)}</td>
                <td><div class="actions">
                    <a href=${`#/bakes/${bake.id}`} aria-label=${`${short}, ${title}`}>${short}</a>
                    <${CancelButton} bake=${bake} label=${title} on_change=${on_change} /></div></td>
            </tr>`;
        })}</tbody>
    </table></div>`;
}
