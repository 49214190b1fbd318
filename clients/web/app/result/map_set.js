// The irradiance maps of a bake, read from maps.f16 and maps.json.
import { from_half } from '../../viewer/half_float.js';

export class MapSet {
    /** page: maps.json; buffer: maps.f16 */
    constructor(page, buffer) {
        this.face_size = page.face_size;
        this.scale = page.scale;
        this.units = page.units;
        this.maps = page.maps;
        this.halves = new Uint16Array(buffer); // little-endian, as is every machine that runs a browser
    }

    /** Linear RGB of a texel of map `m`. */
    value(m, { face, i, j }) {
        const at = this.maps[m].offset / 2 + ((face * this.face_size + j) * this.face_size + i) * 4;
        return [0, 1, 2].map(channel => from_half(this.halves[at + channel]) * this.scale);
    }

    /** The exposure, in stops, at which the brightest texel of map `m` is just below white. */
    exposure(m) {
        let most = 0;
        for (let face = 0; face < 6; ++face)
            for (let j = 0; j < this.face_size; ++j)
                for (let i = 0; i < this.face_size; ++i) most = Math.max(most, ...this.value(m, { face, i, j }));
        return most > 0 ? Math.round(10 * Math.log2(0.9 / most)) / 10 : 0;
    }

    title(m) {
        const { name, theta_prime_deg } = this.maps[m];
        return name === 'diffuse' ? 'Diffuse' : `Specular, θ' = ${Number(theta_prime_deg.toFixed(3))}°`;
    }
}

export async function load_maps(api, bake) {
    const page = await api.json(api.file_url(bake, 'maps.json'));
    const reply = await api.ask(api.file_url(bake, 'maps.f16'));
    return new MapSet(page, await reply.arrayBuffer());
}

/** The sRGB byte of a linear value; values outside [0, 1] are clipped. */
export function srgb_byte(value) {
    if (!(value > 0)) return 0;
    if (value >= 1) return 255;
    return Math.round(255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055));
}
