// A HairView that lives as long as the page shows it.
import { useEffect, useRef, useState } from '../vendor/preact.js';
import { HairView } from './hair_view.js';
import { listen_for_orbit } from './orbit_input.js';

/**
 * Returns { canvas, stage, view, frame_ms, problem, set_problem }. canvas, stage: refs for the canvas and the element
 * that gives its size; view: a ref of the HairView, null without WebGL 2; frame_ms: time of the last frame or null.
 */
export function use_hair_view() {
    const canvas = useRef(null);
    const stage = useRef(null);
    const view = useRef(null);
    const [frame_ms, set_frame_ms] = useState(null);
    const [problem, set_problem] = useState(null);
    useEffect(() => {
        try {
            view.current = new HairView(canvas.current, { drawn: set_frame_ms });
        } catch (error) {
            set_problem(new Error('This browser has no WebGL 2, which the viewer draws with.', { cause: error }));
            return undefined;
        }
        const release = attach(view.current, canvas.current, stage.current, set_problem);
        return () => {
            release();
            view.current.dispose();
            view.current = null;
        };
    }, []);
    return { canvas, stage, view, frame_ms, problem, set_problem };
}

/** Ties the view to the size of `stage` and to the input on `canvas`. Returns a function that unties it. */
function attach(view, canvas, stage, set_problem) {
    const lost = () =>
        set_problem(new Error('The graphics card dropped the picture. Reload the page to draw it again.'));
    canvas.addEventListener('webglcontextlost', lost);
    const fit = () => view.resize(stage.clientWidth, stage.clientHeight, Math.min(devicePixelRatio, 2));
    const observer = new ResizeObserver(fit);
    observer.observe(stage);
    fit();
    const stop_listening = listen_for_orbit(
        canvas,
        view.camera,
        () => view.request_frame(),
        () => view.frame_hair(),
    );
    return () => {
        canvas.removeEventListener('webglcontextlost', lost);
        observer.disconnect();
        stop_listening();
    };
}
