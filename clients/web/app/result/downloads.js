// The table of a bake's files, with the programs that read each format.
import { html, useState } from '../../vendor/preact.js';
import { Heads } from '../parts.js';
import { bytes_text } from '../number_text.js';

// By the end of the name; the first match counts.
const readers = [
    ['_latlong.exr', 'Blender, Godot 4, Unity, three.js; Unreal takes an EXR as 2-D only'],
    ['.exr', 'Unity (vertical strip of six faces), any EXR reader'],
    ['.npy', 'numpy'],
    ['.hair', 'readers of HAIR (Cem Yuksel)'],
    ['.ktx2', "ktx-parse, loaders of KTX 2 cube arrays; not three.js's KTX2Loader, nor Godot (2-D only)"],
    ['.dds', 'Unreal, Godot 4; not three.js (BC6H only)'],
    ['.f16', 'this page, WebGL, WebGPU, three.js DataTexture, numpy'],
    ['strands.bin', 'vertex buffers of WebGL and WebGPU, numpy'],
    ['.glb', 'glTF 2.0 readers'],
    ['.vdb', 'OpenVDB, Blender'],
    ['.json', 'any JSON reader'],
    ['.png', 'any image viewer'],
];

export const readers_of = name => readers.find(([ending]) => name.endsWith(ending))?.[1] ?? '';

const is_slice = name => /^specular_\d+/.test(name);

/** files: of the bake's view; contents: { file name: description } of the manifest. */
export function Downloads({ files, contents }) {
    const [all, set_all] = useState(false);
    const slices = files.filter(({ name }) => is_slice(name)).length;
    const shown = all || slices < 4 ? files : files.filter(({ name }) => !is_slice(name));
    return html`<div>
        <div class="scroll" tabindex="0" role="region" aria-label="Files"><table class="striped">
            <${Heads} titles=${['File', 'Size', 'Content', 'Readers']} />
            <tbody>${shown.map(
                ({ name, href, bytes, sha256 }) => html`<tr key=${name}>
                <td><a href=${href} download=${name} title=${sha256 ? `SHA-256 ${sha256}` : null}>${name}</a></td>
                <td class="number">${bytes === undefined ? '' : bytes_text(bytes)}</td><td>${contents[name] ?? ''}
                    </td><td>${readers_of(name)}</td>
            </tr>`,
            )}</tbody>
        </table></div>
        ${shown.length < files.length && html`<button class="small outline"
            onClick=${() => set_all(true)}>Show ${slices} files of single specular maps</button>`}
    </div>`;
}
