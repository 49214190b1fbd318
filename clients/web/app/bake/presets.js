// The choice of a preset: a named set of the request's settings.
import { html } from '../../vendor/preact.js';

/** presets: [{ name, description }]; value: the chosen name, '' for the defaults. */
export function Presets({ presets, value, on_change }) {
    const chosen = presets.find(({ name }) => name === value);
    return html`<div class="field"><label for="preset">Preset</label>
        <select id="preset" aria-describedby="preset-help" onChange=${event => on_change(event.target.value)}>
            <option value="">default</option>
            ${presets.map(({ name }) => html`<option key=${name} value=${name} selected=${name === value}>${name}
                </option>`)}
        </select>
        <small id="preset-help">
            ${chosen?.description ?? 'Every field has the default of the service.'}</small>
    </div>`;
}
