// Sends one file in pieces that go on after a lost connection or a reload (tus-js-client remembers upload addresses in
// localStorage, by the file's digest).
import { is_turned_away, pause, wait_ms_of } from '../retry.js';

const piece = 8 << 20;
/** Before one try after the other; the count begins anew when something was sent. */
export const delays_ms = [0, 1000, 2000, 4000, 8000, 15000, 30000, 30000, 30000, 30000];

let library = null;

/** tus-js-client is a plain script: window.tus. */
function load_library() {
    library ??= new Promise((resolve, reject) => {
        const script = document.createElement('script');
        script.src = new URL('../../vendor/tus.js', import.meta.url);
        script.onload = () => resolve(window.tus);
        script.onerror = () => {
            library = null;
            reject(new Error('The part of the page that sends files could not be loaded.'));
        };
        document.head.append(script);
    });
    return library;
}

/** What was answered last; nothing where the connection was lost. */
const reply_of = error => error.originalResponse ?? error.causingError?.reply;

/**
 * Worth another try: no answer at all, a conflict with a request that is still being read, what was turned away for
 * now, a fault of the server.
 */
function may_pass(error) {
    const status = reply_of(error)?.getStatus() ?? 0;
    return status === 0 || status === 409 || status === 423 || is_turned_away(status) || status >= 500;
}

/**
 * Waits as long as an answer asks for that passes by itself, then fails with it. tus-js-client knows no Retry-After;
 * and where it asks how much of an upload the service has, it takes such an answer for an upload that is gone and sends
 * all of the file anew.
 */
async function wait_when_turned_away(reply, on_wait, signal) {
    const status = reply.getStatus();
    if (!is_turned_away(status) && status < 500) return;
    const error = Object.assign(new Error(`status ${status}`), { reply });
    if (!signal.aborted) on_wait(words_of(error));
    await pause(wait_ms_of(reply.getHeader('Retry-After')), signal);
    throw error;
}

function words_of(error) {
    const reply = error.reply ?? reply_of(error);
    if (!reply) return 'The connection was lost and did not come back.';
    try {
        return JSON.parse(reply.getBody()).detail;
    } catch {
        return `The service answered ${reply.getStatus()}.`;
    }
}

// A browser that has no room left for the addresses sends nevertheless; only a reload cannot go on.
function lenient(storage) {
    return {
        findAllUploads: () => storage.findAllUploads(),
        findUploadsByFingerprint: fingerprint => storage.findUploadsByFingerprint(fingerprint),
        removeUpload: key => storage.removeUpload(key),
        async addUpload(fingerprint, upload) {
            try {
                return await storage.addUpload(fingerprint, upload);
            } catch {
                return undefined;
            }
        },
    };
}

const options_of = (tus, file, sha256) => ({
    endpoint: '/v1/uploads',
    chunkSize: piece,
    retryDelays: delays_ms,
    metadata: { sha256, filename: file.name },
    fingerprint: async () => `hairbake-${sha256}`,
    urlStorage: lenient(tus.defaultOptions.urlStorage),
    removeFingerprintOnSuccess: true,
    onShouldRetry: may_pass,
});

/**
 * Resolves when the service has the whole file. on_progress(bytes); on_wait(words): why it is asked again later;
 * aborting `signal` ends the upload there too.
 */
export async function send_file(file, sha256, { on_progress, on_wait, signal }) {
    const tus = await load_library();
    signal.throwIfAborted();
    await new Promise((resolve, reject) => {
        const end = () => upload.abort(true).catch(() => {}); // an upload that stays is removed when it expires
        const upload = new tus.Upload(file, {
            ...options_of(tus, file, sha256),
            onProgress: on_progress,
            onSuccess: resolve,
            onAfterResponse: (_, reply) => wait_when_turned_away(reply, on_wait, signal),
            onError: error =>
                reject(Object.assign(new Error(words_of(error)), { status: reply_of(error)?.getStatus() })),
            onUploadUrlAvailable: () => {
                if (signal.aborted) end();
            },
        });
        signal.addEventListener('abort', () => {
            if (upload.url) end(); // else it is just being made and has no address yet
            reject(signal.reason);
        });
        upload.findPreviousUploads().then(earlier => {
            if (signal.aborted) return;
            if (earlier.length) upload.resumeFromPreviousUpload(earlier[0]);
            upload.start();
        }, reject);
    });
}

/** Ends what an earlier send_file of the file left on the service. */
export async function end_upload(file, sha256) {
    const tus = await load_library();
    const upload = new tus.Upload(file, options_of(tus, file, sha256));
    for (const earlier of await upload.findPreviousUploads()) {
        upload.resumeFromPreviousUpload(earlier);
        await upload.abort(true);
    }
}
