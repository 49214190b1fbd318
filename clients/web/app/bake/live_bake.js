// A bake that is watched until it has ended.
import { useEffect, useState } from '../../vendor/preact.js';
import { use_app, use_watch } from '../hooks.js';

export const has_ended = ({ state }) => state === 'done' || state === 'failed' || state === 'cancelled';
export const watch_ms = 700;

/** Returns { bake, problem, again() }; again() starts to watch once more. */
export function use_bake(id) {
    const { announce } = use_app();
    const [round, set_round] = useState(0);
    const { value: bake, problem } = use_watch(`/v1/bakes/${id}`, watch_ms, has_ended, round);
    useEffect(() => {
        if (bake) announce(`The bake is ${bake.state}.`);
    }, [bake?.state]);
    return { bake, problem, again: () => set_round(n => n + 1) };
}
