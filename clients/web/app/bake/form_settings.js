// The settings of the form: the values of all fields but the inputs chosen by picture, and the preset they start from.
import { useMemo, useState } from '../../vendor/preact.js';
import { first_values, merged, with_value } from './request.js';
import { in_new_places } from './request_fields.js';

/**
 * Returns { settings, base, preset, change(path, value), take_preset(name) }. base: the values of the preset, against
 * which changes are counted. A preset leaves meshes and outputs as they are.
 */
export function use_form_settings(schema, presets) {
    const start = useMemo(() => first_values(schema), [schema]);
    const [preset, set_preset] = useState('');
    const [base, set_base] = useState(start);
    const [settings, set_settings] = useState(start);
    const take_preset = name => {
        const given = presets.find(one => one.name === name)?.request ?? {};
        const fresh = merged(start, in_new_places(given));
        const { occluder, receiver, outputs } = settings;
        set_preset(name);
        set_base(fresh);
        set_settings({ ...fresh, occluder, receiver, outputs });
    };
    const change = (path, value) => set_settings(old => with_value(old, path, value));
    return { settings, base, preset, change, take_preset };
}
