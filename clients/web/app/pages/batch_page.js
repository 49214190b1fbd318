// The progress of a batch and its bakes.
import { html, useEffect } from '../../vendor/preact.js';
import { BakeTable } from '../bake/bake_table.js';
import { use_inputs } from '../gallery.js';
import { use_app, use_watch } from '../hooks.js';
import { Cut, Facts, Loading, ProblemNote } from '../parts.js';
import { most_shown } from '../list_pages.js';

const open = ({ states }) => states.queued + states.running;
const has_ended = batch => open(batch) === 0;

export default function BatchPage({ path }) {
    const { announce } = use_app();
    const models = use_inputs('model');
    const environments = use_inputs('environment');
    const address = `/v1/batches/${encodeURIComponent(path[1] ?? '')}`;
    const { value: batch, problem } = use_watch(address, 700, has_ended);
    const left = batch ? open(batch) : -1;
    // The list is watched on its own until all its bakes have ended, so that it shows their last states.
    const { value: list } = use_watch(
        `/v1/bakes?batch=${encodeURIComponent(path[1] ?? '')}&limit=${most_shown}`,
        1000,
        ({ bakes }) => bakes.every(({ state }) => state !== 'queued' && state !== 'running'),
    );
    useEffect(() => {
        if (left === 0) announce('The batch has ended.');
    }, [left]);
    if (!batch) return problem ? html`<${ProblemNote} problem=${problem} />` : html`<${Loading} what="the batch" />`;
    const ended = batch.bakes - left;
    return html`<div>
        <${ProblemNote} problem=${problem} />
        <p id="batch-state">
            ${left === 0 ? `All ${batch.bakes} have ended.` : `${ended} of ${batch.bakes} have ended.`}</p>
        <progress value=${ended} max=${batch.bakes} aria-label="Bakes that have ended"></progress>
        <${Facts} rows=${Object.entries(batch.states).filter(([, count]) => count > 0)} />
        <h2>Bakes</h2>
        ${list && html`<${BakeTable} bakes=${list.bakes} models=${models} environments=${environments} />`}
        <${Cut} more=${list?.next} />
    </div>`;
}
