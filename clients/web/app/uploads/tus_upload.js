// The upload of one file in pieces. It resumes after a lost connection or a reload: tus-js-client keeps addresses of
// uploads in localStorage, by the file's digest.
import { is_turned_away, pause, wait_ms_of } from '../retry.js';

const piece = 8 << 20;
/** The pauses between retries, in order. A sent piece starts the order again. */
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

/** The last reply, undefined when the connection was lost. */
const reply_of = error => error.originalResponse ?? error.causingError?.reply;

/**
 * Whether a retry may succeed: after no reply, a conflict with a request that the service still reads, a reply of
 * is_turned_away, or a fault of the server.
 */
function may_pass(error) {
    const status = reply_of(error)?.getStatus() ?? 0;
    return status === 0 || status === 409 || status === 423 || is_turned_away(status) || status >= 500;
}

/**
 * For a reply after which another try may succeed: waits for the time of its Retry-After and throws it as an Error.
 * tus-js-client ignores Retry-After. When such a reply answers the HEAD for the offset, tus-js-client takes the upload
 * for lost and sends the whole file again.
 */
async function wait_when_turned_away(reply, on_wait, signal) {
    const status = reply.getStatus();
    if (!is_turned_away(status) && status < 500) return;
    const error = Object.assign(new Error(`status ${status}`), { reply });
    if (!signal.aborted) on_wait(message_of(error));
    await pause(wait_ms_of(reply.getHeader('Retry-After')), signal);
    throw error;
}

function message_of(error) {
    const reply = error.reply ?? reply_of(error);
    if (!reply) return 'The connection was lost and did not come back.';
    try {
        return JSON.parse(reply.getBody()).detail;
    } catch {
        return `The service answered ${reply.getStatus()}.`;
    }
}

// Without room for the addresses the upload still works, but a reload cannot resume it.
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
 * Uploads a file. Resolves when the service has all of it.
 * on_progress(bytes): called with the number of bytes sent so far;
 * on_wait(message): called with the reason when a request is repeated later;
 * signal: aborting it ends the upload, also on the service.
 */
export async function send_file(file, sha256, { on_progress, on_wait, signal }) {
    const tus = await load_library();
    signal.throwIfAborted();
    await new Promise((resolve, reject) => {
        const end = () => upload.abort(true).catch(() => {}); // the service removes a remaining upload when it expires
        const upload = new tus.Upload(file, {
            ...options_of(tus, file, sha256),
            onProgress: on_progress,
            onSuccess: resolve,
            onAfterResponse: (_, reply) => wait_when_turned_away(reply, on_wait, signal),
            onError: error =>
                reject(Object.assign(new Error(message_of(error)), { status: reply_of(error)?.getStatus() })),
            onUploadUrlAvailable: () => {
                if (signal.aborted) end();
            },
        });
        signal.addEventListener('abort', () => {
            if (upload.url) end(); // without a URL the upload is still being created
            reject(signal.reason);
        });
        upload.findPreviousUploads().then(earlier => {
            if (signal.aborted) return;
            if (earlier.length) upload.resumeFromPreviousUpload(earlier[0]);
            upload.start();
        }, reject);
    });
}

/** Deletes an unfinished upload of the file from the service. */
export async function end_upload(file, sha256) {
    const tus = await load_library();
    const upload = new tus.Upload(file, options_of(tus, file, sha256));
    for (const earlier of await upload.findPreviousUploads()) {
        upload.resumeFromPreviousUpload(earlier);
        await upload.abort(true);
    }
}
