// Baking a set again under another environment: first what it would cost, then the batch.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { ProblemNote } from '../parts.js';
import { count_text } from '../number_text.js';

const stage_line = ({ transmittance, irradiance }) =>
    [
        count_text(transmittance, 'transmittance'),
        count_text(irradiance, 'set of irradiance maps', 'sets of irradiance maps'),
    ].join(', ');

const is_done = ({ bakes, done_bakes }) => bakes === done_bakes;

const forecast_text = forecast =>
    `${count_text(forecast.bakes, 'bake')}: ` +
    (is_done(forecast)
        ? 'all of them are done already.'
        : `reused are ${stage_line(forecast.reused_stages)}; computed ${stage_line(forecast.computed_stages)}.`);

function Forecast({ forecast }) {
    return html`<dl class="facts" id="forecast">
        <div><dt>Bakes</dt><dd>${forecast.bakes}</dd></div>
        <div><dt>Done already</dt><dd>${forecast.done_bakes}</dd></div>
        <div><dt>Reused</dt><dd>${stage_line(forecast.reused_stages)}</dd></div>
        <div><dt>Computed</dt><dd>${stage_line(forecast.computed_stages)}</dd></div>
    </dl>`;
}

/** request: the body of POST /v1/rebakes, or null while it is not complete. */
export function Rebake({ request, label = 'Re-bake' }) {
    const { api, announce } = use_app();
    const [found, set_state] = useState({});
    const body = request && JSON.stringify(request);
    const state = found.body === body ? found : {}; // not what another request would take
    useEffect(() => {
        if (!body) return undefined;
        let live = true;
        api.post('/v1/rebakes', request, '?dry_run=1').then(
            forecast => {
                if (!live) return;
                set_state({ body, forecast });
                announce(forecast_text(forecast));
            },
            problem => live && set_state({ body, problem }),
        );
        return () => (live = false);
    }, [body]);
    const confirm = async () => {
        set_state({ ...state, busy: true }); // a second click would make a second batch
        try {
            const { id } = await api.post('/v1/rebakes', request);
            location.hash = `#/batches/${id}`;
        } catch (problem) {
            set_state({ ...state, problem, busy: false });
        }
    };
    if (!request) return null;
    return html`<section aria-label="What it takes">
        <${ProblemNote} problem=${state.problem} />
        ${!state.forecast && !state.problem && html`<p aria-busy="true">Counting what is reused</p>`}
        ${
            state.forecast &&
            html`<${Forecast} forecast=${state.forecast} /><button onClick=${confirm}
                disabled=${state.busy} aria-busy=${state.busy ? 'true' : null}>
                ${is_done(state.forecast) ? 'Show' : label} ${count_text(state.forecast.bakes, 'bake')}</button>`
        }
    </section>`;
}
