// A bake's arrays on the graphics card. They leave main memory once they are uploaded.
import * as THREE from '../vendor/three.js';
import { cube_atlas } from './cube_atlas.js';

/** Lines between neighbouring vertices of a strand; the attributes are those of hair_shader.js. */
export function strand_geometry(strands) {
    const geometry = new THREE.BufferGeometry();
    geometry.boundingSphere = new THREE.Sphere(); // else three.js would read the positions, which have left main memory
    geometry.setIndex(attribute(segments(strands.strand_begin), 1));
    geometry.setAttribute('position', attribute(strands.positions, 3));
    geometry.setAttribute('tangent_and_transmittance', halves(strands.tangent_and_transmittance, 4));
    if (strands.bent_cone) geometry.setAttribute('bent_cone', halves(strands.bent_cone, 4));
    if (strands.transmittance_sh) add_harmonics(geometry, strands.transmittance_sh, strands.sh_bands ** 2);
    for (const name of ['positions', 'strand_begin', 'tangent_and_transmittance', 'transmittance_sh', 'bent_cone'])
        delete strands[name];
    return geometry;
}

/** The preprocessor definitions of the shader for these strands. */
export function shader_defines(strands) {
    const count = strands.sh_bands ** 2,
        defines = { SH_COUNT: count, SH_VECTORS: Math.ceil(count / 4) };
    return strands.has_cone ? { ...defines, CONE: 1 } : defines;
}

/**
 * All maps of a bake as the layers of one texture of atlases.
 *
 * Throws an Error when the card cannot hold so many.
 */
export function map_texture(maps, renderer) {
    const gl = renderer.getContext(),
        most_layers = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
    if (maps.count > most_layers)
        throw new Error(
            `This browser draws at most ${most_layers} maps; the bake has ${maps.count}. Bake fewer specular maps.`,
        );
    const { data, width, height, layers } = cube_atlas(maps.texels, maps.face_size, maps.count);
    const texture = new THREE.DataArrayTexture(data, width, height, layers);
    texture.type = THREE.HalfFloatType;
    texture.format = THREE.RGBAFormat;
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.onUpdate = () => (texture.image.data = null);
    texture.needsUpdate = true;
    delete maps.texels;
    return texture;
}

function segments(strand_begin) {
    const strands = strand_begin.length - 1;
    let count = 0;
    for (let s = 0; s < strands; s++) count += Math.max(strand_begin[s + 1] - strand_begin[s] - 1, 0);
    const indices = new Uint32Array(2 * count);
    let at = 0;
    for (let s = 0; s < strands; s++)
        for (let v = strand_begin[s]; v + 1 < strand_begin[s + 1]; v++) {
            indices[at++] = v;
            indices[at++] = v + 1;
        }
    return indices;
}

function attribute(array, size) {
    return freed_after_upload(new THREE.BufferAttribute(array, size));
}

function halves(array, size) {
    const made = attribute(array, size);
    made.isFloat16BufferAttribute = true; // its own constructor would copy the array
    return made;
}

// `count` halves a vertex, as vectors of four. Missing components read as 0, 0, 1; the light's harmonics are 0 there.
function add_harmonics(geometry, array, count) {
    const buffer = freed_after_upload(new THREE.InterleavedBuffer(array, count));
    buffer.isFloat16BufferAttribute = true;
    for (let first = 0; first < count; first += 4)
        geometry.setAttribute(
            `sh${first / 4}`,
            new THREE.InterleavedBufferAttribute(buffer, Math.min(4, count - first), first),
        );
}

function freed_after_upload(buffer) {
    return buffer.onUpload(function () {
        this.array = null;
    });
}
