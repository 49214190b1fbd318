// The page of the viewer. The viewer's module imports three.js, so it is loaded only here.
import { html, useEffect, useState } from '../../vendor/preact.js';
import { bake_title } from '../bake/bake_table.js';
import { use_inputs } from '../gallery.js';
import { use_app } from '../hooks.js';
import { Loading } from '../parts.js';
import { short_digest } from '../name_text.js';

export default function ViewPage({ path }) {
    const { api } = use_app();
    const models = use_inputs('model');
    const environments = use_inputs('environment');
    const [state, set_state] = useState({});
    useEffect(() => {
        import('../../viewer/viewer_page.js').then(
            module => set_state({ ViewerPage: module.ViewerPage }),
            error => set_state({ error }),
        );
    }, []);
    const [, left, right = null] = path;
    if (!left) return html`<p>Which bake? <a href="#/bakes">Choose one</a>.</p>`;
    if (state.error) return html`<p role="alert">The viewer could not be loaded: ${state.error.message}</p>`;
    if (!state.ViewerPage) return html`<${Loading} what="the viewer" />`;
    const title = bake => `${short_digest(bake.id)}: ${bake_title(bake, models, environments)}`;
    return html`<${state.ViewerPage} left=${left} right=${right} api=${api} title=${title} />`;
}
