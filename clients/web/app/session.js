// Signing in and out. The service exchanges a token for a cookie that scripts cannot read. The page stores only whether
// there is a session.
import { html, useState } from '../vendor/preact.js';
import { use_app } from './hooks.js';
import { ProblemNote } from './parts.js';
import { forget_files } from './uploads/kept_files.js';
import { forget_names } from './uploads/uploads.js';

const flag = 'hairbake.session';

export function TokenForm({ on_open }) {
    const { api } = use_app();
    const [problem, set_problem] = useState(null);
    const open = async event => {
        event.preventDefault();
        const token = new FormData(event.target).get('token').trim();
        try {
            await api.ask('/v1/session', { method: 'POST', headers: { Authorization: `Bearer ${token}` } });
            localStorage.setItem(flag, 'open');
            on_open();
        } catch (failure) {
            set_problem(
                failure.status === 401
                    ? { message: 'The service does not know this token, or the token has expired.' }
                    : failure,
            );
        }
    };
    return html`<form class="narrow" onSubmit=${open}>
        <h1>A token is needed</h1>
        <p>This service needs a token. Its operator makes tokens with <code>hairbaked token new</code>.</p>
        <label>Token <input type="password" name="token" autocomplete="current-password" required autofocus /></label>
        <${ProblemNote} problem=${problem} />
        <button type="submit">Open</button>
    </form>`;
}

export function SignOut() {
    const { api } = use_app();
    const [problem, set_problem] = useState(null);
    if (localStorage.getItem(flag) === null) return null;
    const close = async () => {
        try {
            await api.remove('/v1/session');
        } catch (failure) {
            if (failure.status !== 401) return set_problem(failure); // 401: the session has ended already
        }
        localStorage.removeItem(flag);
        forget_names();
        await forget_files();
        location.reload();
    };
    return html`<li><button class="outline small" onClick=${close}>Sign out</button>
        <${ProblemNote} problem=${problem} /></li>`;
}
