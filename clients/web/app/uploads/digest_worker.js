// Digests one file after the other beside the page, so that it stays responsive. Not by WebCrypto: that wants a file in
// one piece, and is absent where a page comes over plain HTTP.
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
