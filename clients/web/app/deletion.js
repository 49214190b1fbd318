// The deletion of an input, with the questions before it.

/** `problem`: the Problem of a refused deletion. Lines that tell what refers to the input, as the service lists it. */
export function needed_lines({ needed_by }) {
    const part = (name, more, line) => {
        const { count = 0, first = [] } = needed_by?.[name] ?? {};
        const rest = count - first.length;
        return [...first.map(line), ...(rest > 0 ? [`and ${rest} more ${more}`] : [])];
    };
    return [
        ...part('names', 'versions of names', ({ kind, path, version }) => `name ${kind}/${path}, version ${version}`),
        ...part('bakes', 'bakes', ({ id, state }) => `bake ${id.slice(0, 12)} (${state})`),
    ];
}

/** The question before a deletion by force. */
export const force_question = (label, problem) =>
    [
        `${label} is needed:`,
        ...needed_lines(problem),
        'Results stay. A bake that has to run again needs the file again. Delete it all the same?',
    ].join('\n');

/**
 * Deletes the input at the address `path`. Asks first, and once more when something refers to it. Returns whether it
 * was deleted.
 */
export async function delete_input(api, path, label) {
    if (!confirm(`Delete ${label} and its file?`)) return false;
    try {
        await api.remove(path);
        return true;
    } catch (problem) {
        if (problem.status !== 409 || problem.field !== 'force') throw problem;
        if (!confirm(force_question(label, problem))) return false;
    }
    await api.remove(`${path}?force=1`);
    return true;
}
