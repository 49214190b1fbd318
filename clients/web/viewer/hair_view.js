// Draws one bake, or two side by side, on a canvas: WebGL 2, three.js LineSegments, the shader of hair_shader.js.
// It draws only on request: a request is one frame at the browser's next animation frame.
import * as THREE from '../vendor/three.js';
import { map_texture, shader_defines, strand_geometry } from './gpu_data.js';
import { fragment_shader, hidden_by, most_lights, vertex_shader } from './hair_shader.js';
import { gain_of, light_direction, light_irradiance, no_edit, rotation_matrix } from './lighting_edit.js';
import { OrbitCamera } from './orbit_camera.js';
import { harmonics } from './shader_math.js';

export { most_lights };

/** Light brown hair with an albedo of 0.6: the defaults of `hairbake render`. */
export const default_look = { albedo: 0.6, color: [0.78, 0.52, 0.3], specular: 0.06 };

/** The brightness of the picture is within -most_stops to most_stops. */
export const most_stops = 32;

/**
 * The settings of one side. bake: index of the bake; part: all, diffuse, specular or transmittance;
 * with_transmittance: whether the light is multiplied by A; hidden_by: how the hair blocks added lights;
 * as_baked: whether the edit is left out.
 */
export const default_side = {
    bake: 0,
    part: 'all',
    with_transmittance: true,
    hidden_by: 'automatic',
    as_baked: false,
};

export class HairView {
    camera = new OrbitCamera();
    #three = new THREE.PerspectiveCamera();
    #bakes = []; // {bake, scene, material}
    #sides = [default_side];
    #geometries = new Map(); // by strands
    #textures = new Map(); // by maps
    #look = default_look;
    #edit = no_edit();
    #display_stops = 0;
    #request = 0;

    /**
     * drawn(ms): called after each frame with its time.
     *
     * Throws without WebGL 2.
     */
    constructor(canvas, { antialias = true, drawn = () => {} } = {}) {
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias, alpha: true });
        this.renderer.autoClear = false;
        this.renderer.setClearColor(0, 0);
        this.drawn = drawn;
    }

    // --- what is shown; every change asks for a frame ----------------------------------------------------------------

    /** One or two bakes of load_bake(). Their arrays move to the card; those of earlier bakes are freed. */
    set_bakes(bakes) {
        const strands = new Set(bakes.map(bake => bake.strands)),
            maps = new Set(bakes.map(bake => bake.maps));
        for (const { material } of this.#bakes) material.dispose();
        keep_only(this.#geometries, strands);
        keep_only(this.#textures, maps);
        this.#bakes = bakes.map(bake => this.#bake_on_card(bake));
        this.#sides = this.#sides.filter(side => side.bake < bakes.length);
        if (!this.#sides.length) this.#sides = [default_side];
        this.request_frame();
    }

    /** One or two of {...default_side}; `bake` is an index of set_bakes(). */
    set_sides(sides) {
        this.#sides = sides;
        this.request_frame();
    }

    /** { albedo in [0, 1], color: linear RGB, specular: Ks }; Kd = albedo color / pi^2. */
    set_look(look) {
        this.#look = look;
        this.request_frame();
    }

    /** An edit of lighting_edit.js. */
    set_lighting(edit) {
        this.#edit = edit;
        this.request_frame();
    }

    /** The brightness of the picture on the screen; it does not change the lighting. */
    set_display_stops(stops) {
        this.#display_stops = stops;
        this.request_frame();
    }

    resize(width, height, pixel_ratio = 1) {
        this.renderer.setPixelRatio(pixel_ratio);
        this.renderer.setSize(width, height, false);
        this.request_frame();
    }

    /** Moves the camera until all hair is in the picture. */
    frame_hair() {
        const size = this.renderer.getSize(new THREE.Vector2());
        if (this.#bakes.length) this.camera.frame(this.#bounds(), size.x / this.#sides.length / size.y);
        this.request_frame();
    }

    // --- pictures ----------------------------------------------------------------------------------------------------

    request_frame() {
        this.#request ||= requestAnimationFrame(() => {
            this.#request = 0;
            this.draw();
        });
    }

    /** Draws now and waits for the card, so that the measured time is that of the whole frame. */
    draw() {
        if (!this.#bakes.length) return;
        const begin = performance.now(),
            gl = this.renderer.getContext();
        this.#draw_to(null);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        this.drawn(performance.now() - begin);
    }

    /** Linear radiance, RGBA floats, rows from the bottom; alpha is 1 on hair and 0 elsewhere. */
    linear_pixels(width, height) {
        const target = new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType, samples: 0 });
        const pixels = new Float32Array(4 * width * height);
        this.#draw_to(target);
        this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
        this.renderer.setRenderTarget(null);
        target.dispose();
        return pixels;
    }

    /** The picture as a PNG on `background`, a CSS colour: a Blob. */
    screenshot(background) {
        this.draw();
        const source = this.renderer.domElement,
            copy = document.createElement('canvas');
        copy.width = source.width;
        copy.height = source.height;
        const context = copy.getContext('2d');
        context.fillStyle = background;
        context.fillRect(0, 0, copy.width, copy.height);
        context.drawImage(source, 0, 0);
        return new Promise(resolve => copy.toBlob(resolve, 'image/png'));
    }

    /** The stops at which the brightest tenth of the hair is bright but not clipped (core/output/tone.h). */
    automatic_stops() {
        const pixels = this.linear_pixels(192, 144),
            luminances = [];
        for (let i = 0; i < pixels.length; i += 4)
            if (pixels[i + 3] > 0)
                luminances.push(0.2126 * pixels[i] + 0.7152 * pixels[i + 1] + 0.0722 * pixels[i + 2]);
        const sorted = Float64Array.from(luminances).sort();
        const tenth = sorted[sorted.length - 1 - Math.floor(sorted.length / 10)];
        return tenth > 0 ? Math.min(Math.max(Math.log2(0.35 / tenth), -most_stops), most_stops) : 0;
    }

    /** Buffers and textures on the card: {geometries, textures}. */
    memory() {
        const { geometries, textures } = this.renderer.info.memory;
        return { geometries, textures };
    }

    dispose() {
        cancelAnimationFrame(this.#request);
        this.set_bakes([]);
        cancelAnimationFrame(this.#request);
        this.renderer.dispose();
        this.renderer.forceContextLoss();
    }

    // -----------------------------------------------------------------------------------------------------------------

    #bake_on_card(bake) {
        const { strands, maps } = bake,
            defines = shader_defines(strands);
        if (!this.#textures.has(maps)) this.#textures.set(maps, map_texture(maps, this.renderer));
        if (!this.#geometries.has(strands)) this.#geometries.set(strands, strand_geometry(strands));
        const material = new THREE.RawShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader: vertex_shader,
            fragmentShader: fragment_shader,
            defines,
            uniforms: uniforms_of(bake, this.#textures.get(maps)),
        });
        const lines = new THREE.LineSegments(this.#geometries.get(strands), material);
        lines.frustumCulled = false;
        const scene = new THREE.Scene();
        scene.add(lines);
        return { bake, scene, material, defines };
    }

    #bounds() {
        const boxes = this.#bakes.map(({ bake }) => bake.strands.bounds);
        return [Math.min, Math.max].map((of, end) => [0, 1, 2].map(axis => of(...boxes.map(box => box[end][axis]))));
    }

    #draw_to(target) {
        const size = target
            ? new THREE.Vector2(target.width, target.height)
            : this.renderer.getSize(new THREE.Vector2());
        const part = Math.floor(size.x / this.#sides.length);
        this.renderer.setRenderTarget(target);
        this.#look_through(target, 0, size.x, size.y);
        this.renderer.clear();
        this.#sides.forEach((side, k) => {
            const { scene, material, defines } = this.#bakes[side.bake];
            this.#look_through(target, k * part, part, size.y);
            this.camera.apply(this.#three, this.#bounds(), part / size.y);
            this.#set_uniforms(material.uniforms, side, defines, target !== null);
            material.uniformsNeedUpdate = true;
            this.renderer.render(scene, this.#three);
        });
    }

    #look_through(target, x, width, height) {
        for (const place of ['Viewport', 'Scissor'])
            if (target) target[place.toLowerCase()].set(x, 0, width, height);
            else this.renderer[`set${place}`](x, 0, width, height);
        if (target) target.scissorTest = true;
        else this.renderer.setScissorTest(true);
        this.renderer.setRenderTarget(target);
    }

    #set_uniforms(uniforms, side, defines, linear) {
        const { albedo, color, specular } = this.#look,
            edit = side.as_baked ? no_edit() : this.#edit;
        const set = (name, value) => (uniforms[name].value = value);
        const kd = side.part === 'specular' ? 0 : albedo / Math.PI ** 2,
            ks = side.part === 'diffuse' ? 0 : specular;
        set('u_kd', new THREE.Vector3(...color).multiplyScalar(kd));
        set('u_ks', new THREE.Vector3(ks, ks, ks));
        set('u_apply_transmittance', side.with_transmittance);
        set('u_show_transmittance', side.part === 'transmittance');
        const [a, b, c] = rotation_matrix(edit.rotation_deg); // its transpose turns back
        uniforms.u_to_maps.value.set(a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]);
        set('u_map_gain', new THREE.Vector3(...gain_of(edit)).multiplyScalar(uniforms.u_map_scale.value));
        set('u_linear', linear);
        set('u_display_gain', 2 ** this.#display_stops);
        set('u_hidden_by', hiding(side.hidden_by, defines));
        set_lights(uniforms, edit.lights, defines);
    }
}

function keep_only(resources, wanted) {
    for (const [key, resource] of resources)
        if (!wanted.has(key)) {
            resource.dispose();
            resources.delete(key);
        }
}

function uniforms_of({ maps }, texture) {
    const vectors = (count, Type) => Array.from({ length: count }, () => new Type());
    const values = {
        u_maps: texture,
        u_map_scale: maps.scale,
        u_face_size: maps.face_size,
        u_intervals: maps.count - 2,
        u_exponent: maps.exponent,
        u_to_maps: new THREE.Matrix3(),
        u_map_gain: null,
        u_kd: null,
        u_ks: null,
        u_apply_transmittance: true,
        u_show_transmittance: false,
        u_linear: false,
        u_display_gain: 1,
        u_lights: 0,
        u_hidden_by: 0,
        u_light_direction: vectors(most_lights, THREE.Vector3),
        u_light_irradiance: vectors(most_lights, THREE.Vector3),
        u_light_harmonics: vectors(4 * most_lights, THREE.Vector4),
    };
    return Object.fromEntries(Object.entries(values).map(([name, value]) => [name, { value }]));
}

function set_lights(uniforms, lights, defines) {
    uniforms.u_lights.value = Math.min(lights.length, most_lights);
    lights.slice(0, most_lights).forEach((light, i) => {
        const direction = light_direction(light);
        uniforms.u_light_direction.value[i].set(...direction);
        uniforms.u_light_irradiance.value[i].set(...light_irradiance(light));
        const y = harmonics(direction).map((value, k) => (k < defines.SH_COUNT ? value : 0));
        for (let k = 0; k < 4; k++) uniforms.u_light_harmonics.value[4 * i + k].fromArray(y, 4 * k);
    });
}

// The shader's number for a requested way. If the bake lacks its data: the best that it has, in the order harmonics,
// bent cone, A.
function hiding(wish, defines) {
    const has = { harmonics: defines.SH_VECTORS > 0, cone: 'CONE' in defines, average: true };
    return hidden_by[has[wish] ? wish : ['harmonics', 'cone', 'average'].find(way => has[way])];
}
