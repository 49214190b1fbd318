// Names and digests as text.

export const short_digest = digest => digest.slice(0, 10);

/** "face_size" -> "Face size". */
export function title_text(name) {
    const text = name
        .replaceAll('_', ' ')
        .replace(/\bsh\b/, 'SH')
        .replace(/\bdeg$/, '')
        .replace(/\bkajiya kay\b/, 'Kajiya-Kay')
        .trim();
    return text[0].toUpperCase() + text.slice(1);
}

/** A file's name as a name in the service: letters, digits, '.', '_', '-' (names.cpp). */
export function name_from_file(file_name) {
    const stem = file_name.replace(/\.[^.]{1,5}$/, '');
    return stem
        .replace(/[^A-Za-z0-9._-]+/g, '-')
        .replace(/^[-.]+|[-.]+$/g, '')
        .slice(0, 100);
}
