// Inputs with their labels.
import { html } from '../vendor/preact.js';
import { from_hex, to_hex } from './color.js';

export function Slider({ label, value, min, max, step = 0.01, unit = '', on }) {
    const text = `${Number(value.toFixed(3))}${unit && ` ${unit}`}`;
    // The number is outside the label: the label would name an output inside it instead of the slider.
    return html`<div class="viewer-slider">
        <label>
            <span>${label}</span>
            <input type="range" min=${min} max=${max} step=${step} value=${value} aria-valuetext=${text}
                onInput=${event => on(event.target.valueAsNumber)} />
        </label>
        <output>${text}</output>
    </div>`;
}

export function Choice({ label, value, options, on }) {
    return html`<label>
        ${label}
        <select value=${value} onChange=${event => on(event.target.value)}>
            ${Object.entries(options).map(
                ([key, text]) => html`<option value=${key} selected=${key === value}>${text}</option>`,
            )}
        </select>
    </label>`;
}

export function Tick({ label, checked, disabled = false, on }) {
    return html`<label>
        <input type="checkbox" checked=${checked} disabled=${disabled} onChange=${event => on(event.target.checked)} />
        ${label}
    </label>`;
}

/** `value` is linear RGB in [0, 1]. */
export function Color({ label, value, on }) {
    return html`<label>
        ${label}
        <input type="color" value=${to_hex(value)} onInput=${event => on(from_hex(event.target.value))} />
    </label>`;
}
