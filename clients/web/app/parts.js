// Small pieces of pages.
import { html } from '../vendor/preact.js';
import { most_shown } from './list_pages.js';

/** A failure, read out at once. */
export function ProblemNote({ problem }) {
    return problem ? html`<p class="problem" role="alert">${problem.message}</p>` : null;
}

export function Loading({ what }) {
    return html`<p aria-busy="true">Loading ${what}</p>`;
}

/** Under a list that was too long to show. */
export function Cut({ more }) {
    return more ? html`<p class="cut">Only the first ${most_shown.toLocaleString('en')} are shown; the service's API
        lists all.</p>` : null;
}

/** rows: [term, text or node] */
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

/** The head of a table. */
export function Heads({ titles }) {
    return html`<thead><tr>${titles.map(title => html`<th scope="col" key=${title}>${title}</th>`)}</tr></thead>`;
}

const state_marks = { queued: '◷', running: '▶', done: '✓', failed: '✕', cancelled: '–' };

/** A state by word and sign, not by colour alone. */
export function State({ state }) {
    return html`<span class=${`state state-${state}`}><span aria-hidden="true">${state_marks[state] ?? ''}
        </span> ${state}</span>`;
}
