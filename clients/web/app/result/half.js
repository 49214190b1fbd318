// Arrays of half floats, as strands.bin holds them.
import { from_half } from '../../viewer/half.js';

/** Every `stride`-th of the half floats, from the one at `first`. */
export function half_values(halves, first, stride) {
    const values = new Float32Array(Math.ceil((halves.length - first) / stride));
    for (let i = 0, at = first; i < values.length; ++i, at += stride) values[i] = from_half(halves[at]);
    return values;
}
