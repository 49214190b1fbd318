// The histogram of A over the vertices, with mean, median and range.
import { html, useEffect, useRef, useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { Facts, Loading, ProblemNote } from '../parts.js';
import { count_text, number_text } from '../number_text.js';
import { half_values } from '../../viewer/half_float.js';

const bins = 50;

/** Statistics of values in [0, 1]: { counts in equal bins, mean, low, median, high }; 90 % lie from low to high. */
export function spread(values) {
    const counts = new Array(bins).fill(0);
    let sum = 0;
    for (const value of values) {
        counts[Math.max(0, Math.min(bins - 1, Math.floor(value * bins)))] += 1;
        sum += value;
    }
    const sorted = Float32Array.from(values).sort();
    const part = share => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
    return { counts, mean: sum / values.length, low: part(0.05), median: part(0.5), high: part(0.95) };
}

/** A of every vertex. Only the array that holds it is fetched from strands.bin. */
async function load_transmittance(api, bake) {
    const page = await api.json(api.file_url(bake, 'strands.json'));
    const { offset, bytes } = page.arrays.find(({ name }) => name === 'tangent_and_transmittance');
    const reply = await api.ask(api.file_url(bake, 'strands.bin'), {
        headers: { Range: `bytes=${offset}-${offset + bytes - 1}` },
    });
    const buffer = await reply.arrayBuffer();
    const from = reply.status === 206 ? 0 : offset; // a proxy may ignore ranges and send all
    return half_values(new Uint16Array(buffer, from, bytes / 2), 3, 4);
}

function load_style() {
    const href = new URL('../../vendor/uplot.css', import.meta.url).href;
    if (document.querySelector(`link[href="${href}"]`)) return;
    document.head.append(Object.assign(document.createElement('link'), { rel: 'stylesheet', href }));
}

async function draw(parent, counts) {
    load_style();
    const { default: uPlot } = await import('../../vendor/uplot.js');
    const color = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis = {
        stroke: color('--pico-color'),
        grid: { stroke: color('--pico-muted-border-color'), width: 1 },
        ticks: { stroke: color('--pico-muted-border-color') },
    };
    const centers = counts.map((_, i) => (i + 0.5) / bins);
    return new uPlot(
        {
            width: Math.max(280, parent.clientWidth),
            height: 240,
            scales: { x: { time: false, range: [0, 1] } },
            axes: [
                { ...axis, label: 'A' },
                { ...axis, label: 'vertices', size: 80 },
            ],
            series: [
                { label: 'A' },
                {
                    label: 'vertices',
                    stroke: color('--pico-primary'),
                    fill: color('--pico-primary'),
                    paths: uPlot.paths.bars({ size: [0.9] }),
                    points: { show: false },
                },
            ],
        },
        [centers, counts],
        parent,
    );
}

/** Whether the system's colour scheme is dark; the component is drawn again when that changes. */
function use_dark() {
    const query = matchMedia('(prefers-color-scheme: dark)');
    const [dark, set_dark] = useState(query.matches);
    useEffect(() => {
        const follow = () => set_dark(query.matches);
        query.addEventListener('change', follow);
        return () => query.removeEventListener('change', follow);
    }, []);
    return dark;
}

/** Whether the element of `ref` has been near the visible part of the page. */
function use_seen(ref) {
    const [seen, set_seen] = useState(false);
    useEffect(() => {
        const observer = new IntersectionObserver(
            entries => entries.some(({ isIntersecting }) => isIntersecting) && set_seen(true),
            { rootMargin: '100px' },
        );
        observer.observe(ref.current);
        return () => observer.disconnect();
    }, []);
    return seen;
}

/** A of a large groom is many megabytes, so it is fetched when the user scrolls to it. */
export function Histogram({ bake }) {
    const place = useRef(null);
    const seen = use_seen(place);
    return html`<div class="histogram" ref=${place}>${seen && html`<${Chart} bake=${bake} />`}</div>`;
}

function Chart({ bake }) {
    const { api } = use_app();
    const dark = use_dark();
    const [{ numbers, count, problem }, take] = useState({});
    const parent = useRef(null);
    useEffect(() => {
        load_transmittance(api, bake).then(
            values => take({ numbers: spread(values), count: values.length }),
            failure => take({ problem: failure }),
        );
    }, [bake]);
    useEffect(() => {
        if (!numbers) return undefined;
        let live = true;
        let plot = null;
        const fit = () => plot?.setSize({ width: Math.max(280, parent.current.clientWidth), height: 240 });
        draw(parent.current, numbers.counts).then(drawn => {
            if (live) plot = drawn;
            else drawn.destroy();
        });
        const observer = new ResizeObserver(fit);
        observer.observe(parent.current);
        return () => {
            live = false;
            observer.disconnect();
            plot?.destroy();
        };
    }, [numbers, dark]);
    if (problem) return html`<${ProblemNote} problem=${problem} />`;
    if (!numbers) return html`<${Loading} what="the transmittance" />`;
    return html`<div>
        <div class="chart" ref=${parent} role="img" aria-label="Histogram of A; its statistics are listed below"></div>
        <${Facts} rows=${[
            ['Vertices', count_text(count, 'vertex', 'vertices')],
            ['Mean of A', number_text(numbers.mean)],
            ['Median', number_text(numbers.median)],
            ['90 % of vertices lie in', `${number_text(numbers.low)} to ${number_text(numbers.high)}`],
        ]} />
    </div>`;
}
