// A worker that computes the SHA-256 digest of one file after the other, so that the page stays responsive. WebCrypto
// is not enough: it takes a file in one piece only, and is missing where the page comes over plain HTTP.
import { sha256 } from '../../vendor/hashes/sha2.js';

const piece = 4 << 20;

async function digest(file) {
    const sha = sha256.create();
    for (let at = 0; at < file.size; at += piece) {
        sha.update(new Uint8Array(await file.slice(at, at + piece).arrayBuffer()));
        postMessage({ done: Math.min(at + piece, file.size) });
    }
    return Array.from(sha.digest(), byte => byte.toString(16).padStart(2, '0')).join('');
}

onmessage = async ({ data: file }) => {
    try {
        postMessage({ sha256: await digest(file) });
    } catch (error) {
        postMessage({ error: `The file cannot be read: ${error.message}` });
    }
};
