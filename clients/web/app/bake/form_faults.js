// What is wrong in the form: { dotted path of the field: message }.
import { title_text } from '../name_text.js';
import { faults } from './schema.js';

/** The faults that the page finds itself. waits: by field, why its file is not stored yet; null once it is. */
export function faults_of_form(schema, request, waits) {
    const wrong = Object.fromEntries(
        faults(schema, request).map(({ path, message }) => [path, `${title_text(path)} ${message}.`]),
    );
    if (!request.hair && !request.environment) wrong.hair = 'A hair model, an environment, or one of each is needed.';
    for (const [name, message] of Object.entries(waits)) if (message) wrong[name] = message;
    return wrong;
}

/** The fault that the service found, from its Problem or null: "irradiance.lights[0]" is "irradiance.lights.0" here. */
export const faults_of_problem = problem =>
    problem?.field ? { [problem.field.replaceAll(/\[(\d+)\]/g, '.$1')]: problem.message } : {};

/** The faults that are shown before the form is submitted: all but missing inputs and inputs still being sent. */
export const early_faults = (wrong, waits) =>
    Object.fromEntries(Object.entries(wrong).filter(([path]) => path !== 'hair' && !waits[path]));

/**
 * The fault of the field at `path` or of a part of it, or undefined: { message, place }. place: the wrong part within
 * the field, '' for all of it ("2" of "irradiance.tint.2").
 */
export function fault_of(wrong, path) {
    const own = path.join('.');
    const found = Object.keys(wrong).find(other => other === own || other.startsWith(`${own}.`));
    return found && { message: wrong[found], place: found.slice(own.length + 1) };
}

/** Moves the focus to the first wrong field; opens its part of the form if that is closed. */
export function focus_first_fault(form) {
    const wrong = form.querySelector('[aria-invalid=true]');
    for (let fold = wrong?.closest('details'); fold; fold = fold.parentElement.closest('details')) fold.open = true;
    const field = wrong?.matches('fieldset') ? wrong.querySelector('input') : wrong;
    (field ?? form.querySelector('.problem'))?.scrollIntoView({ block: 'center' });
    field?.focus({ preventScroll: true });
}
