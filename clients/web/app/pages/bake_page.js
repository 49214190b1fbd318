// The page that asks for a bake.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { BakeForm } from '../bake/bake_form.js';
import { use_app } from '../hooks.js';
import { Loading, ProblemNote } from '../parts.js';

export default function BakePage({ query }) {
    const { api } = use_app();
    const [state, set_state] = useState({});
    useEffect(() => {
        api.contract().then(
            contract => set_state({ contract }),
            problem => set_state({ problem }),
        );
    }, []);
    if (state.problem) return html`<${ProblemNote} problem=${state.problem} />`;
    if (!state.contract) return html`<${Loading} what="the form" />`;
    return html`<${BakeForm} ...${state.contract} query=${query} />`;
}
