// The page of one bake: its progress until it has ended, then its result.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { bake_title } from '../bake/bake_table.js';
import { BakeProgress } from '../bake/bake_progress.js';
import { use_bake } from '../bake/live_bake.js';
import { use_inputs } from '../gallery.js';
import { Loading, ProblemNote } from '../parts.js';

/** Loads the module of the result, which only a finished bake needs. */
function Result({ bake }) {
    const [state, set_state] = useState({});
    useEffect(() => {
        import('../result/result.js').then(
            module => set_state({ Content: module.Result }),
            problem => set_state({ problem }),
        );
    }, []);
    if (state.problem) return html`<${ProblemNote} problem=${state.problem} />`;
    return state.Content ? html`<${state.Content} bake=${bake} />` : html`<${Loading} what="the result" />`;
}

export default function OneBakePage({ path }) {
    const { bake, problem, again } = use_bake(path[1]);
    const models = use_inputs('model');
    const environments = use_inputs('environment');
    if (!bake) return problem ? html`<${ProblemNote} problem=${problem} />` : html`<${Loading} what="the bake" />`;
    return html`<div>
        <p>${bake_title(bake, models, environments)}</p>
        <${ProblemNote} problem=${problem} />
        <${BakeProgress} bake=${bake} on_change=${again} />
        ${bake.state === 'done' && html`<${Result} bake=${bake} />`}
        <details><summary>The request</summary><pre tabindex="0">${JSON.stringify(bake.request, null, 2)}</pre>
            </details>
    </div>`;
}
