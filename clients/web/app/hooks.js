// What most pages need: the app's services, a document fetched once, one watched, a list with pages.
import { createContext, useCallback, useContext, useEffect, useState } from '../vendor/preact.js';

/** { api, uploads, announce(text) } */
export const AppContext = createContext(null);
export const use_app = () => useContext(AppContext);

/** { value, problem, reload } of a GET; nothing is asked while path is null. */
export function use_json(path) {
    const { api } = use_app();
    const [state, set_state] = useState({});
    const [round, set_round] = useState(0);
    useEffect(() => {
        if (path === null) return undefined;
        const abort = new AbortController();
        api.json(path, { signal: abort.signal }).then(
            value => set_state({ value }),
            problem => abort.signal.aborted || set_state({ problem }),
        );
        return () => abort.abort();
    }, [path, round]);
    return { ...state, reload: useCallback(() => set_round(n => n + 1), []) };
}

/**
 * { value, problem } of a GET that is asked again every `every_ms` until `ended(value)`; another `round` begins anew.
 */
export function use_watch(path, every_ms, ended = () => false, round = 0) {
    const { api } = use_app();
    const [state, set_state] = useState({});
    useEffect(() => {
        const abort = new AbortController();
        const take = value => (set_state({ value }), ended(value));
        api.watch(path, every_ms, take, problem => set_state(old => ({ ...old, problem })), abort.signal);
        return () => abort.abort();
    }, [path, round]);
    return state;
}

/** Every item of a list that comes in pages, or as many as are worth showing, asked for once. */
export async function all_pages(api, path, key, most = 1000) {
    const items = [];
    for (let cursor = ''; items.length < most;) {
        const page = await api.json(path + (path.includes('?') ? '&' : '?') + `limit=200${cursor}`);
        items.push(...page[key]);
        if (!page.next) break;
        cursor = `&cursor=${encodeURIComponent(page.next)}`;
    }
    return items;
}

/** { items, problem, reload } of all pages of a list; `most` as for all_pages. */
export function use_list(path, key, most = undefined) {
    const { api } = use_app();
    const [state, set_state] = useState({ items: null });
    const [round, set_round] = useState(0);
    useEffect(() => {
        let live = true;
        all_pages(api, path, key, most).then(
            items => live && set_state({ items }),
            problem => live && set_state({ items: [], problem }),
        );
        return () => (live = false);
    }, [path, key, round]);
    return { ...state, reload: useCallback(() => set_round(n => n + 1), []) };
}
