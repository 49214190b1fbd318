// Meshes and their names: heads that shadow the hair, and surfaces that the hair shadows. The service lists only meshes
// that have a name, so an uploaded mesh is given a name here.
import { html, useState } from '../../vendor/preact.js';
import { NameForm } from '../gallery.js';
import { use_app, use_list } from '../hooks.js';
import { label_of } from '../input_facts.js';
import { Cut, Heads, Loading, ProblemNote } from '../parts.js';
import { UploadPanel } from '../uploads/upload_panel.js';
import { file_names } from '../uploads/uploads.js';
import { name_from_file } from '../name_text.js';
import { time_text } from '../time_text.js';

/** The meshes that this page has uploaded and that have no name yet. */
function Nameless({ named, on_named }) {
    const { uploads } = use_app();
    const jobs = uploads.jobs.filter(
        ({ kind, phase, sha256 }) => kind === 'mesh' && phase === 'stored' && !named.has(sha256),
    );
    return jobs.map(
        ({ id, sha256, file }) => html`<article key=${id}><h3>Name ${file.name}</h3>
            <${NameForm} entry=${{ kind: 'mesh', id: sha256 }} suggestion=${name_from_file(file.name)}
                on_named=${on_named} /></article>`,
    );
}

function Named({ names }) {
    const files = file_names();
    return html`<div class="scroll" tabindex="0" role="region" aria-label="Named meshes"><table class="striped">
        <${Heads} titles=${['Name', 'Version', 'File', 'Since']} />
        <tbody>${names.map(
            ({ path, version, sha256, created }) => html`<tr key=${path}>
            <td><a href=${`#/names/mesh/${path}`}>${path}</a></td><td>${version}</td>
            <td>${label_of(sha256, {}, files)}</td><td>${time_text(created)}</td></tr>`,
        )}</tbody>
    </table></div>`;
}

export default function MeshesPage() {
    const { items, more, problem, reload } = use_list('/v1/names/mesh', 'names');
    const [, redraw] = useState(0);
    const named = new Set((items ?? []).map(({ sha256 }) => sha256));
    return html`<div>
        <p>A bake takes a mesh as <em>occluder</em>, which shadows the hair, or as <em>receiver</em>, which the hair
            shadows.</p>
        <${UploadPanel} kind="mesh" accept=".obj,.ply,.glb,.gltf" label="Drop meshes here, or pick them: OBJ, PLY, glTF"
            on_stored=${() => redraw(n => n + 1)} />
        <${ProblemNote} problem=${problem} />
        ${!items && html`<${Loading} what="the names" />`}
        ${items && html`<${Nameless} named=${named} on_named=${reload} />`}
        <h2>Named meshes</h2>
        ${items?.length === 0 && html`<p>No mesh has a name yet.</p>`}
        ${items?.length > 0 && html`<${Named} names=${items} />`}
        <${Cut} more=${more} />
    </div>`;
}
