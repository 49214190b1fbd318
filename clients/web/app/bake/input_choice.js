// An input of the form that is chosen by picture: the file, and how the request refers to it.
import { html, useState } from '../../vendor/preact.js';
import { use_inputs } from '../gallery.js';
import { Picker, Reference } from './picker.js';
import { names_of, reference_to } from './request.js';

/**
 * kind: 'model' or 'environment'; first: digest chosen at first, or ''.
 * Returns { kind, inputs, id, value, choose(id), refer_by(name) }: the stored inputs, the chosen digest, and the value
 * of the request's field.
 */
export function use_input_choice(kind, first) {
    const inputs = use_inputs(kind);
    const [chosen, set_chosen] = useState({ id: first });
    return {
        kind,
        inputs,
        id: chosen.id,
        value: reference_to(chosen, inputs),
        choose: id => set_chosen({ id }),
        refer_by: by => set_chosen({ ...chosen, by }),
    };
}

/**
 * choice: of use_input_choice; none: label of the choice of no file; fault: id of the element with the error
 * message, if there is one; on_change(): called with each change.
 */
export function InputChoice({ choice, title, none, fault, on_change }) {
    const { kind, inputs, id, value } = choice;
    const then = act => chosen => {
        on_change();
        act(chosen);
    };
    return html`<${Picker} kind=${kind} title=${title} inputs=${inputs} value=${id} none=${none} fault=${fault}
            on_change=${then(choice.choose)} />
        <${Reference} title=${title} names=${names_of(id, inputs)} value=${value}
            on_change=${then(choice.refer_by)} />`;
}
