// The button that bakes a set again under another environment, with the forecast of the work above it.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { count_text } from '../number_text.js';
import { ProblemNote } from '../parts.js';
import { Forecast, forecast_text, is_done } from './rebake_forecast.js';

/** request: the body of POST /v1/rebakes, or null while it is not complete. */
export function Rebake({ request, label = 'Re-bake' }) {
    const { api, announce } = use_app();
    const [found, set_state] = useState({});
    const body = request && JSON.stringify(request);
    const state = found.body === body ? found : {}; // a forecast of another request is not shown
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
    return html`<section aria-label="The work it takes">
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
