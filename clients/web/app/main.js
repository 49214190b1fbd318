// The application: navigation, the token form, the current page, announcements for screen readers.
import { html, render, useEffect, useMemo, useRef, useState } from '../vendor/preact.js';
import { Api } from './api.js';
import { AppContext } from './hooks.js';
import { ProblemNote } from './parts.js';
import { page_of, read_route } from './routes.js';
import { SignOut, TokenForm } from './session.js';
import { Uploads } from './uploads/uploads.js';

const sections = [
    ['environments', 'Environments'],
    ['models', 'Models'],
    ['meshes', 'Meshes'],
    ['bake', 'New bake'],
    ['bakes', 'Bakes'],
    ['rebake', 'Re-bake'],
];

function Navigation({ current }) {
    return html`<header class="container">
        <nav aria-label="Pages">
            <ul><li><strong><a href="#/" class="contrast">hairbake</a></strong></li></ul>
            <ul class="sections">
                ${sections.map(
                    ([name, title]) => html`<li key=${name}>
                    <a href=${`#/${name}`} aria-current=${name === current ? 'page' : null}>${title}</a>
                </li>`,
                )}
                <${SignOut} />
            </ul>
        </nav>
    </header>`;
}

/** A page is kept while the key stays: the viewer keeps its camera, edit and strands when it shows other bakes. */
const key_of = ({ path, query }) => JSON.stringify(path[0] === 'view' ? ['view'] : [path, query]);

/** Moves the focus to a new page's heading, so that a screen reader reads it. first: the page was opened directly. */
function Page({ route, first }) {
    const page = page_of(route.path);
    const [state, set_state] = useState({});
    const heading = useRef(null);
    const key = key_of(route);
    useEffect(() => {
        document.title = `${page?.title ?? 'Not found'} · hairbake`;
        if (!first) heading.current?.focus();
        if (!page) return undefined;
        let live = true;
        page.load().then(
            module => live && set_state({ key, Content: module.default }),
            problem => live && set_state({ key, problem }),
        );
        return () => (live = false);
    }, [key]);
    const shown = state.key === key;
    return html`<main class="container" id="main">
        <h1 tabindex="-1" ref=${heading}>${page?.title ?? 'There is no such page'}</h1>
        ${shown && html`<${ProblemNote} problem=${state.problem} />`}
        ${shown && state.Content && html`<${state.Content} key=${key} path=${route.path} query=${route.query} />`}
    </main>`;
}

function use_route() {
    const [state, set_state] = useState({ route: read_route(location.hash), first: true });
    useEffect(() => {
        const follow = () => set_state({ route: read_route(location.hash), first: false });
        addEventListener('hashchange', follow);
        return () => removeEventListener('hashchange', follow);
    }, []);
    return state;
}

function App() {
    const { route, first } = use_route();
    const [locked, set_locked] = useState(false);
    const [message, set_message] = useState('');
    const app = useMemo(() => {
        const api = new Api(() => set_locked(true));
        const announce = text => set_message(text);
        return { api, announce, uploads: new Uploads(api, announce) };
    }, []);
    const unlock = () => {
        set_locked(false);
        app.uploads.resume();
    };
    useEffect(() => app.uploads.resume(), []);
    return html`<${AppContext.Provider} value=${app}>
        <a class="skip" href="#main" onClick=${skip}>Skip to the content</a>
        <${Navigation} current=${route.path[0] ?? 'environments'} />
        ${
            locked
                ? html`<main class="container" id="main"><${TokenForm} on_open=${unlock} /></main>`
                : html`<${Page} route=${route} first=${first} />`
        }
        <div class="visually-hidden" role="status">${message}</div>
    <//>`;
}

function skip(event) {
    event.preventDefault(); // the router would look for a page '#main'
    document.querySelector('main h1')?.focus();
}

document.querySelector('#app').replaceChildren();
render(html`<${App} />`, document.querySelector('#app'));
