// The parts of the form that are no block of settings: meshes and priority, outputs.
import { html } from '../../vendor/preact.js';
import { Field } from './field.js';
import { fault_of } from './form_faults.js';
import { MeshField } from './mesh_field.js';
import { Fold } from './settings_block.js';

const meshes = ['occluder', 'receiver'];

/** on_wait(name, message): why a picked mesh is not stored yet; null once it is stored. */
export function MeshesAndPriority({ schema, values, wrong, on_change, on_wait }) {
    return html`<${Fold} title="Meshes and priority" faulty=${[...meshes, 'priority'].some(name => wrong[name])}>
        <div class="fields">
            ${meshes.map(
                name => html`<${MeshField} key=${name} name=${name} schema=${schema.properties[name]}
                    value=${values[name]} fault=${wrong[name]} on_change=${value => on_change([name], value)}
                    on_wait=${message => on_wait(name, message)} />`,
            )}
            <${Field} path=${['priority']} schema=${schema.properties.priority} value=${values.priority}
                fault=${fault_of(wrong, ['priority'])} on_change=${value => on_change(['priority'], value)} />
        </div>
    <//>`;
}

export function Outputs({ schema, values, wrong, on_change }) {
    return html`<${Field} path=${['outputs']} schema=${schema.properties.outputs} value=${values.outputs}
            fault=${fault_of(wrong, ['outputs'])} on_change=${value => on_change(['outputs'], value)} />
        ${!values.outputs.includes('raw') && html`<p
            class="help">Without raw, this page has no maps, histogram or viewer for the bake.</p>`}`;
}
