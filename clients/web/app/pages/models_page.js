import { html } from '../../vendor/preact.js';
import { Gallery } from '../gallery.js';

export default function ModelsPage() {
    return html`<${Gallery} kind="model" accept=".hair,.tfx,.data"
        label="Drop hair models here, or pick them: HAIR (Cem Yuksel) or TressFX"
        empty="No hair model is stored yet." />`;
}
