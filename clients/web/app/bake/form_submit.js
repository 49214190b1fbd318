// Posts the form's request unless the page finds faults in it. Keeps a refusal of the service as the problem.
import { useState } from '../../vendor/preact.js';
import { use_app } from '../hooks.js';
import { count_text } from '../number_text.js';
import { focus_first_fault } from './form_faults.js';

/**
 * own_faults: what the page finds wrong in `request`; form: a ref of the form's element.
 * Returns { submit, submitted, problem, clear() }. submitted: whether the user tried to submit; problem: the service's
 * last refusal or null, which clear() forgets.
 */
export function use_form_submit(request, own_faults, form) {
    const { api, announce } = use_app();
    const [submitted, set_submitted] = useState(false);
    const [problem, set_problem] = useState(null);
    const clear = () => set_problem(null);
    const show_fault = () => setTimeout(() => focus_first_fault(form.current)); // after the fault is drawn
    const submit = async event => {
        event.preventDefault();
        set_submitted(true);
        clear(); // the reason of the last refusal may be gone, so the request is posted again
        const count = Object.keys(own_faults).length;
        if (count > 0) {
            announce(`${count_text(count, 'field')} to correct.`);
            return show_fault();
        }
        try {
            const { id } = await api.post('/v1/bakes', request);
            location.hash = `#/bakes/${id}`;
        } catch (failure) {
            set_problem(failure);
            show_fault();
        }
    };
    return { submit, submitted, problem, clear };
}
