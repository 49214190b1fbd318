// All uploads, one after the other. They continue while the user changes pages.
import { is_turned_away, pause } from '../retry.js';
import { forget_file, keep_file, kept_file, kept_files } from './kept_files.js';
import { delays_ms, end_upload, send_file } from './tus_upload.js';

/** Whether a retry would fail too. After 401 a token may be entered; a reply of is_turned_away is temporary. */
const is_final = status => status >= 400 && status < 500 && status !== 401 && !is_turned_away(status);

/**
 * A job: { id, kind: 'model' | 'environment' | 'mesh', file, phase, done, known, sha256, entry, problem, waits }.
 * phase: waiting, digesting, sending, reading (by the service), stored, failed; done: bytes of the phase;
 * known: whether the service had the file; entry: the service's view of the input;
 * problem: message of the failure; waits: why a request is repeated later, if it is.
 */
export class Uploads {
    jobs = [];
    #api;
    #announce;
    #listeners = new Set();
    #running = false;
    #stops = new Map(); // by job id: AbortController
    #holds = new Map(); // by job id: its lock, see hold()

    constructor(api, announce) {
        this.#api = api;
        this.#announce = announce;
    }

    /** Calls `callback` after every change. Returns a function that ends the calls. */
    listen(callback) {
        this.#listeners.add(callback);
        return () => this.#listeners.delete(callback);
    }

    add(kind, files) {
        for (const file of files) {
            const job = { id: random_id(), kind, file, phase: 'waiting', done: 0 };
            this.jobs = [...this.jobs, job];
            this.#holds.set(job.id, hold(job.id));
            keep_file({ id: job.id, kind, file });
        }
        this.#changed();
        this.#run();
    }

    /** Resumes uploads that a reload or a closed tab interrupted, and those that failed without a token. */
    async resume() {
        for (const job of this.jobs)
            if (job.phase === 'failed' && job.status === 401) this.#update(job, { phase: 'waiting' });
        this.#run();
        for (const { id } of await kept_files()) if (!this.#holds.has(id)) this.#resume_kept(id);
    }

    async #resume_kept(id) {
        const held = hold(id);
        this.#holds.set(id, held);
        await held.granted; // at once, or when the tab that sends the file is closed
        const kept = await kept_file(id);
        if (!kept) return this.#release(id);
        this.jobs = [...this.jobs, { ...kept, phase: 'waiting', done: 0 }];
        this.#changed();
        this.#run();
    }

    async #release(id) {
        await forget_file(id);
        this.#holds.get(id)?.release();
        this.#holds.delete(id);
    }

    again(job) {
        this.#update(job, { phase: 'waiting', problem: null, done: 0 });
        this.#run();
    }

    /** Removes a job from the list, even while its file is sent. An unfinished upload is deleted from the service. */
    remove(job) {
        const stop = this.#stops.get(job.id);
        stop?.abort(new Error('stopped'));
        if (!stop && job.sha256 && job.phase !== 'stored') end_upload(job.file, job.sha256).catch(() => {});
        this.#release(job.id);
        this.jobs = this.jobs.filter(({ id }) => id !== job.id);
        this.#changed();
    }

    async #run() {
        if (this.#running) return;
        this.#running = true;
        try {
            for (let job; (job = this.jobs.find(({ phase }) => phase === 'waiting'));) await this.#send(job);
        } finally {
            this.#running = false;
        }
    }

    async #send(job) {
        const stop = new AbortController();
        const { signal } = stop;
        this.#stops.set(job.id, stop);
        try {
            this.#update(job, { phase: 'digesting', done: 0 });
            const sha256 = await digest_of(job.file, done => this.#update(job, { done }), signal);
            const known = await this.#send_unless_stored(job, sha256, signal);
            signal.throwIfAborted();
            this.#update(job, { phase: 'reading', sha256, known, waits: null });
            const read = () => this.#api.post(`/v1/${job.kind}s`, { sha256 });
            const entry = job.kind === 'mesh' ? null : await this.#with_retries(job, read, signal);
            signal.throwIfAborted();
            remember_name(sha256, job.file.name);
            this.#update(job, { phase: 'stored', entry, waits: null });
            this.#announce(`${job.file.name} is stored.`);
            this.#release(job.id);
        } catch (error) {
            if (signal.aborted) return;
            this.#update(job, { phase: 'failed', problem: error.message, status: error.status, waits: null });
            if (is_final(error.status)) this.#release(job.id);
        } finally {
            this.#stops.delete(job.id);
        }
    }

    /** Sends the file unless the service has it; true if it had. Waits while another tab sends the same file. */
    async #send_unless_stored(job, sha256, signal) {
        const turn = hold(sha256);
        const stopped = new Promise((_, reject) => signal.addEventListener('abort', () => reject(signal.reason)));
        try {
            await Promise.race([turn.granted, stopped]);
            if (await this.#with_retries(job, () => this.#is_stored(sha256, signal), signal)) return true;
            this.#update(job, { phase: 'sending', sha256, done: 0, waits: null });
            await send_file(job.file, sha256, {
                on_progress: done => this.#update(job, { done, waits: null }),
                on_wait: reason => this.#wait(job, reason),
                signal,
            });
            return false;
        } finally {
            turn.release();
        }
    }

    async #is_stored(sha256, signal) {
        try {
            await this.#api.ask(`/v1/blobs/${sha256}`, { method: 'HEAD', signal });
            return true;
        } catch (problem) {
            signal.throwIfAborted();
            if (problem.status === 404) return false;
            throw problem;
        }
    }

    /** Repeats a request that is turned away, as often as the upload of a piece is repeated. */
    async #with_retries(job, ask, signal) {
        for (const delay_ms of delays_ms)
            try {
                return await ask();
            } catch (problem) {
                if (!is_turned_away(problem.status)) throw problem;
                this.#wait(job, problem.message);
                await pause(Math.max(delay_ms, problem.wait_ms), signal);
                signal.throwIfAborted();
            }
        return ask();
    }

    #wait(job, reason) {
        if (job.waits !== reason) this.#announce(`${job.file.name} waits: ${reason}`);
        this.#update(job, { waits: reason });
    }

    #update(job, change) {
        Object.assign(job, change);
        this.#changed();
    }
    #changed() {
        for (const callback of this.#listeners) callback();
    }
}

// crypto.randomUUID exists only on localhost and over TLS.
function random_id() {
    return Array.from(crypto.getRandomValues(new Uint32Array(4)), word => word.toString(16)).join('-');
}

/**
 * A lock that one tab at a time holds: on a kept file by its id, on the upload of a file by its digest. The browser
 * releases the locks of a closed tab. Browsers have such locks only on localhost and over TLS; elsewhere the lock is
 * granted at once, and every tab resumes the uploads that it finds.
 * Returns { granted, release() }; granted: a promise.
 */
function hold(id) {
    let release;
    const released = new Promise(resolve => (release = resolve));
    const granted = new Promise(resolve => {
        if (!navigator.locks) return resolve();
        const own = () => (resolve(), released);
        navigator.locks.request(`hairbake-upload-${id}`, own).catch(resolve); // no locks without storage
    });
    return { granted, release };
}

function digest_of(file, on_progress, signal) {
    return new Promise((resolve, reject) => {
        const worker = new Worker(new URL('./digest_worker.js', import.meta.url), { type: 'module' });
        const end = (act, value) => {
            worker.terminate();
            act(value);
        };
        worker.onmessage = ({ data }) => {
            if (data.done !== undefined) on_progress(data.done);
            else if (data.sha256) end(resolve, data.sha256);
            else end(reject, new Error(data.error));
        };
        worker.onerror = () => end(reject, new Error('The digest of the file could not be computed.'));
        signal.addEventListener('abort', () => end(reject, signal.reason));
        worker.postMessage(file);
    });
}

const names_key = 'hairbake.file-names';
const most_names = 500;

/** Stores a file's name in this browser. The service knows the file by its digest only. */
function remember_name(sha256, name) {
    const names = file_names();
    delete names[sha256];
    names[sha256] = name;
    try {
        localStorage.setItem(names_key, JSON.stringify(Object.fromEntries(Object.entries(names).slice(-most_names))));
    } catch {
        // No room: the file is shown by its digest.
    }
}

/** The names of uploaded files in this browser: { sha256: file name }. */
export function file_names() {
    try {
        return JSON.parse(localStorage.getItem(names_key)) ?? {};
    } catch {
        return {};
    }
}

/** Removes the file names and the addresses of uploads (of tus-js-client) from this browser. */
export function forget_names() {
    for (const key of Object.keys(localStorage))
        if (key === names_key || key.startsWith('tus::')) localStorage.removeItem(key);
}
