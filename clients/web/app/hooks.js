// What most pages need: the app's services, a document fetched once, one watched, a list with pages.
import { createContext, useCallback, useContext, useEffect, useState } from '../vendor/preact.js';
import { most_shown } from './words.js';

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

// The most that the service gives at once, by what the list is of.
const page_sizes = { bakes: 1000, names: 1000, models: 200, environments: 200 };

/** { items, more } of a list that comes in pages: most_shown items or fewer, and whether there are more. */
async function all_pages(api, path, key) {
    const items = [];
    const limit = page_sizes[key];
    for (let cursor = '';;) {
        const page = await api.json(path + (path.includes('?') ? '&' : '?') + `limit=${limit}${cursor}`);
        items.push(...page[key]);
        if (!page.next || items.length >= most_shown) return { items, more: Boolean(page.next) };
        cursor = `&cursor=${encodeURIComponent(page.next)}`;
    }
}

/** { items, more, problem, reload } of such a list. */
export function use_list(path, key) {
    const { api } = use_app();
    const [state, set_state] = useState({ items: null });
    const [round, set_round] = useState(0);
    useEffect(() => {
        let live = true;
        all_pages(api, path, key).then(
            list => live && set_state(list),
            problem => live && set_state({ items: [], problem }),
        );
        return () => (live = false);
    }, [path, key, round]);
    return { ...state, reload: useCallback(() => set_round(n => n + 1), []) };
}
