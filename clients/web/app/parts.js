// Small components that many pages use.
import { html } from '../vendor/preact.js';
import { most_shown } from './list_pages.js';

/** An error message; a screen reader reads it at once. */
export function ProblemNote({ problem }) {
    return problem ? html`<p class="problem" role="alert">${problem.message}</p>` : null;
}

export function Loading({ what }) {
    return html`<p aria-busy="true">Loading ${what}</p>`;
}

/** The note under a list that is cut off. */
export function Cut({ more }) {
    return more ? html`<p class="cut">Only the first ${most_shown.toLocaleString('en')} are shown; the service's API
        lists all.</p>` : null;
}

/** A list of terms. rows: [term, text or node] */
export function Facts({ rows }) {
    return html`<dl class="facts">
        ${rows.map(([term, text]) => html`<div key=${term}><dt>${term}</dt><dd>${text}</dd></div>`)}
    </dl>`;
}

export function Warnings({ texts }) {
    if (!texts.length) return null;
    return html`<ul class="warnings" aria-label="Warnings">
        ${texts.map(text => html`<li key=${text}>${text}</li>`)}
    </ul>`;
}

/** The header row of a table. */
export function Heads({ titles }) {
    return html`<thead><tr>${titles.map(title => html`<th scope="col" key=${title}>${title}</th>`)}</tr></thead>`;
}

const state_marks = { queued: '◷', running: '▶', done: '✓', failed: '✕', cancelled: '–' };

/** A bake's state as a word and a sign, so that it does not depend on colour alone. */
export function State({ state }) {
    return html`<span class=${`state state-${state}`}><span aria-hidden="true">${state_marks[state] ?? ''}
        </span> ${state}</span>`;
}
