// Camera control by pointer, wheel and keys. One pointer orbits, or moves the target with shift or the second button.
// Two pointers zoom and move.

const degrees_a_height = 180; // turn of a drag over the picture's height
const step_deg = 5;

/**
 * Listens on `element`. moved(): called after each change; frame(): called by the key F.
 * Returns a function that stops listening.
 */
export function listen_for_orbit(element, camera, moved, frame) {
    const pointers = new Map();
    const listeners = {
        pointerdown: event => {
            element.setPointerCapture(event.pointerId);
            pointers.set(event.pointerId, point_of(event));
        },
        pointermove: event => {
            if (!pointers.has(event.pointerId)) return;
            const before = [...pointers.values()],
                last = pointers.get(event.pointerId);
            pointers.set(event.pointerId, point_of(event));
            if (before.length === 1) drag(camera, element, last, point_of(event), event);
            else pinch(camera, element, before, [...pointers.values()]);
            moved();
        },
        pointerup: event => pointers.delete(event.pointerId),
        pointercancel: event => pointers.delete(event.pointerId),
        contextmenu: event => event.preventDefault(),
        wheel: event => {
            event.preventDefault();
            camera.zoom(Math.exp(Math.min(Math.max(event.deltaY, -200), 200) * 0.0015));
            moved();
        },
        keydown: event => {
            if (event.ctrlKey || event.metaKey || event.altKey || !key(camera, event, frame)) return;
            event.preventDefault();
            moved();
        },
    };
    for (const [name, listener] of Object.entries(listeners))
        element.addEventListener(name, listener, { passive: false });
    return () => {
        for (const [name, listener] of Object.entries(listeners)) element.removeEventListener(name, listener);
    };
}

function point_of(event) {
    return [event.clientX, event.clientY];
}

function drag(camera, element, from, to, event) {
    const x = (to[0] - from[0]) / element.clientHeight,
        y = (to[1] - from[1]) / element.clientHeight;
    if (event.shiftKey || event.buttons & 2) camera.pan(x, -y);
    else camera.orbit(-x * degrees_a_height, y * degrees_a_height);
}

function pinch(camera, element, before, after) {
    const spread = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]);
    const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    camera.zoom(spread(before) / Math.max(spread(after), 1));
    const [from, to] = [middle(before), middle(after)];
    camera.pan((to[0] - from[0]) / element.clientHeight, -(to[1] - from[1]) / element.clientHeight);
}

// Moves the camera by a key. Returns whether the key is one of the viewer's.
function key(camera, { key: name, shiftKey: shift }, frame) {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (name in arrows) {
        const [x, y] = arrows[name];
        if (shift) camera.pan(x * 0.05, y * 0.05);
        else camera.orbit(x * step_deg, y * step_deg);
    } else if (name === '+' || name === '=') camera.zoom(1 / 1.1);
    else if (name === '-') camera.zoom(1.1);
    else if (name === 'f' || name === 'F') frame();
    else return false;
    return true;
}
