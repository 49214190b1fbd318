// Digests one file after the other beside the page, so that it stays responsive.
import { Sha256 } from './sha256.js';

const piece = 4 << 20;

async function digest(file) {
    const sha = new Sha256();
    for (let at = 0; at < file.size; at += piece) {
        sha.add(new Uint8Array(await file.slice(at, at + piece).arrayBuffer()));
        postMessage({ done: Math.min(at + piece, file.size) });
    }
    return sha.hex();
}

onmessage = async ({ data: file }) => {
    try {
        postMessage({ sha256: await digest(file) });
    } catch (error) {
        postMessage({ error: `The file cannot be read: ${error.message}` });
    }
};
