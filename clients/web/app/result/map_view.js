// The irradiance maps as pictures: net or lat-long, at any exposure, with the value under the pointer.
import { html, useEffect, useMemo, useRef, useState } from '../../vendor/preact.js';
import { from_half } from '../../viewer/half_float.js';
import { use_app } from '../hooks.js';
import { Facts, Loading, ProblemNote } from '../parts.js';
import { number_text } from '../number_text.js';
import { face_names, latlong_direction, layout_of, texel_direction, texel_of } from './cube.js';
import { load_maps, srgb_byte } from './map_set.js';

const most_stops = 32; // as in the viewer
const lat_long_width = 1024; // at most

/** As layout_of, but a lat-long picture is at most 1024 pixels wide, even if it then leaves out texels. */
function picture_layout(kind, n) {
    const width = 16 * n;
    if (kind === 'net' || width <= lat_long_width) return layout_of(kind, n);
    const height = lat_long_width / 2;
    return {
        width: lat_long_width,
        height,
        texel: (x, y) => texel_of(latlong_direction(x, y, lat_long_width, height), n),
    };
}

/** The index of each pixel's texel in a map, -1 outside of the faces. It is computed once for all exposures. */
function texel_numbers({ width, height, texel }, n) {
    const numbers = new Int32Array(width * height);
    for (let y = 0, at = 0; y < height; ++y)
        for (let x = 0; x < width; ++x, ++at) {
            const found = texel(x, y);
            numbers[at] = found ? (found.face * n + found.j) * n + found.i : -1;
        }
    return numbers;
}

/** The sRGB byte of every half float, by its bits. */
function byte_table(gain) {
    const bytes = new Uint8Array(65536);
    for (let bits = 0; bits < 0x7c00; ++bits) bytes[bits] = srgb_byte(from_half(bits) * gain);
    bytes[0x7c00] = 255; // infinite; negative values and NaN stay black
    return bytes;
}

function draw(canvas, set, m, { width, height }, numbers, stops) {
    canvas.width = width;
    canvas.height = height;
    const image = new ImageData(width, height);
    const bytes = byte_table(set.scale * 2 ** stops);
    const first = set.maps[m].offset / 2;
    for (let pixel = 0; pixel < numbers.length; ++pixel) {
        if (numbers[pixel] < 0) continue; // stays transparent
        const from = first + 4 * numbers[pixel];
        for (let channel = 0; channel < 3; ++channel)
            image.data[4 * pixel + channel] = bytes[set.halves[from + channel]];
        image.data[4 * pixel + 3] = 255;
    }
    canvas.getContext('2d').putImageData(image, 0, 0);
}

function Readout({ set, m, texel }) {
    const value = set.value(m, texel);
    const direction = texel_direction(texel, set.face_size);
    return html`<div class="readout"><${Facts} rows=${[
        ['Value, linear RGB', html`<output id="texel-value">${value.map(x => number_text(x, 5)).join(', ')}</output>`],
        ['Texel', `${face_names[texel.face]}, column ${texel.i}, row ${texel.j}`],
        ['Tangent', direction.map(x => number_text(x, 3)).join(', ')],
        ['Units', set.units],
    ]} /></div>`;
}

const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function Picture({ set, m, kind, stops, on_texel }) {
    const canvas = useRef(null);
    const at = useRef([0, 0]);
    const layout = useMemo(() => picture_layout(kind, set.face_size), [kind, set]);
    const numbers = useMemo(() => texel_numbers(layout, set.face_size), [layout]);
    useEffect(() => draw(canvas.current, set, m, layout, numbers, stops), [set, m, numbers, stops]);
    const look = (x, y) => {
        const texel = layout.texel(x, y);
        if (!texel) return false;
        at.current = [x, y];
        on_texel(texel);
        return true;
    };
    useEffect(() => void look(Math.floor(layout.width * 0.375), Math.floor(layout.height / 2)), [layout]);
    const move = event => {
        const box = canvas.current.getBoundingClientRect();
        look(
            Math.floor(((event.clientX - box.left) / box.width) * layout.width),
            Math.floor(((event.clientY - box.top) / box.height) * layout.height),
        );
    };
    const step = event => {
        const [dx, dy] = arrows[event.key] ?? [];
        if (dx === undefined) return;
        event.preventDefault();
        look(at.current[0] + dx, at.current[1] + dy);
    };
    const place = kind === 'net' ? 'a net of the cube' : 'a lat-long picture';
    const label = `${set.title(m)}, as ${place}; the arrow keys move the point whose value is read`;
    return html`<canvas class="map-canvas" ref=${canvas} tabindex="0" role="img" onPointerMove=${move}
        onPointerDown=${move} onKeyDown=${step}
        aria-label=${label}></canvas>`;
}

function MapControls({ set, m, set_m, kind, set_kind, stops, set_stops, auto, set_auto }) {
    const last = set.maps.length - 2; // specular maps are 0 to M
    return html`<div>
        <fieldset><legend>Map</legend>
            <label><input type="radio" name="map" checked=${m === 0} onChange=${() => set_m(0)} /> Diffuse</label>
            <label><input type="radio" name="map" checked=${m > 0}
                onChange=${() => set_m(1 + Math.floor(last / 2))} /> Specular</label>
        </fieldset>
        ${
            m > 0 &&
            html`<label>θ' of the specular map: ${Number(set.maps[m].theta_prime_deg.toFixed(3))}°
            <input type="range" id="theta" min="0" max=${last} value=${m - 1} aria-valuetext=${set.title(m)}
                onInput=${event => set_m(1 + Number(event.target.value))} /></label>`
        }
        <fieldset><legend>Laid out as</legend>
            <label><input type="radio" name="layout" checked=${kind === 'net'}
                onChange=${() => set_kind('net')} /> Net of the cube</label>
            <label><input type="radio" name="layout" checked=${kind === 'latlong'}
                onChange=${() => set_kind('latlong')} /> Lat-long</label>
        </fieldset>
        <label>Exposure: ${stops > 0 ? '+' : ''}${stops.toFixed(1)} stops
            <input type="range" id="exposure" min=${-most_stops} max=${most_stops} step="0.1" value=${stops}
                onInput=${event => {
                    set_auto(false);
                    set_stops(Number(event.target.value));
                }} /></label>
        <label><input type="checkbox" checked=${auto}
            onChange=${event => set_auto(event.target.checked)} /> Exposure by the map's brightest texel</label>
    </div>`;
}

export function MapView({ bake }) {
    const { api } = use_app();
    const [{ set, problem }, take] = useState({});
    const [m, set_m] = useState(0);
    const [kind, set_kind] = useState('net');
    const [chosen, set_stops] = useState(0);
    const [auto, set_auto] = useState(true);
    const [texel, set_texel] = useState(null);
    useEffect(() => {
        load_maps(api, bake).then(
            loaded => take({ set: loaded }),
            failure => take({ problem: failure }),
        );
    }, [bake]);
    const own = useMemo(() => set && Math.min(Math.max(set.exposure(m), -most_stops), most_stops), [set, m]);
    if (!set)
        return problem
            ? html`<${ProblemNote} problem=${problem} />`
            : html`<div class="maps"><div class="map-place"><${Loading} what="the maps" /></div></div>`;
    const stops = auto ? own : chosen;
    return html`<div class="maps">
        <div><p id="map-title"><strong>${set.title(m)}</strong></p>
            <div class="map-place"><${Picture} set=${set} m=${m} kind=${kind} stops=${stops} on_texel=${set_texel} />
                </div>
            ${texel && html`<${Readout} set=${set} m=${m} texel=${texel} />`}</div>
        <${MapControls} ...${{ set, m, set_m, kind, set_kind, stops, set_stops, auto, set_auto }} />
    </div>`;
}
