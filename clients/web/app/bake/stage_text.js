// Stages of a bake as text. A stage that is not in the table is shown by its own name.
import { title_text } from '../name_text.js';
import { count_text } from '../number_text.js';

const stages = {
    transmittance: { title: 'Transmittance', one: 'transmittance', many: 'transmittances' },
    irradiance: { title: 'Irradiance maps', one: 'set of irradiance maps', many: 'sets of irradiance maps' },
};

export const stage_title = name => (Object.hasOwn(stages, name) ? stages[name].title : title_text(name));

/** counts: { stage: count }, as the service sends them -> "2 transmittances, 1 set of irradiance maps". */
export function stage_counts_text(counts) {
    return Object.entries(counts)
        .map(([name, count]) => {
            const { one, many } = Object.hasOwn(stages, name) ? stages[name] : { one: name, many: name };
            return count_text(count, one, many);
        })
        .join(', ');
}

/**
 * What a stage does now: its phase while it runs, the trouble of the machine that it waits for, else its state.
 * stage: an entry of a bake's `stages`.
 */
export function phase_text({ state, phase, trouble }) {
    if (trouble) return `waits, because the machine is in trouble (${trouble})`;
    if (state !== 'running') return state;
    return phase ? title_text(phase) : 'starting';
}
