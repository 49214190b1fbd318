// The work that a batch takes before it is started: what is reused and what is computed.
import { html } from '../../vendor/preact.js';
import { count_text } from '../number_text.js';
import { stage_counts_text } from './stage_text.js';

/** Whether nothing is left to bake. */
export const is_done = ({ bakes, done_bakes }) => bakes === done_bakes;

/** One sentence, for a screen reader. forecast: the answer of POST /v1/rebakes?dry_run=1. */
export function forecast_text(forecast) {
    const bakes = count_text(forecast.bakes, 'bake');
    if (is_done(forecast)) return `${bakes}: all of them are done already.`;
    const { reused_stages, computed_stages } = forecast;
    return `${bakes}: reused are ${stage_counts_text(reused_stages)}; computed ${stage_counts_text(computed_stages)}.`;
}

export function Forecast({ forecast }) {
    return html`<dl class="facts" id="forecast">
        <div><dt>Bakes</dt><dd>${forecast.bakes}</dd></div>
        <div><dt>Done already</dt><dd>${forecast.done_bakes}</dd></div>
        <div><dt>Reused</dt><dd>${stage_counts_text(forecast.reused_stages)}</dd></div>
        <div><dt>Computed</dt><dd>${stage_counts_text(forecast.computed_stages)}</dd></div>
    </dl>`;
}
