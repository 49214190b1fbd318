// Hooks that several pages use: the services of the app, a document, a watched document, a list.
import { createContext, useCallback, useContext, useEffect, useState } from '../vendor/preact.js';
import { all_pages } from './list_pages.js';

/** { api, uploads, announce(text) } */
export const AppContext = createContext(null);
export const use_app = () => useContext(AppContext);

/** Fetches `path` once; nothing while it is null. Returns { value, problem, reload() }. */
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
 * Fetches `path` every `every_ms` until `ended(value)` is true. Another `round` starts again.
 * Returns { value, problem }.
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

/** A list of the service, see all_pages. Returns { items, more, problem, reload() }; items is null at first. */
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
