// SHA-256 (FIPS 180-4) in pieces: WebCrypto wants a file in one, and is absent where a page comes over plain HTTP.

const constants = new Uint32Array(64);
const start = new Uint32Array(8);

// The first 32 bits of the fractions of cube and square roots of the first primes. The roots are found in integers:
// floor(2^32 p^(1/k)) mod 2^32.
function root_bits(prime, k) {
    const target = BigInt(prime) << BigInt(32 * k);
    let root = BigInt(Math.floor(prime ** (1 / k) * 2 ** 32));
    while (root ** BigInt(k) > target) --root;
    while ((root + 1n) ** BigInt(k) <= target) ++root;
    return Number(root & 0xffffffffn);
}

for (let number = 2, found = 0; found < 64; ++number) {
    let prime = true;
    for (let d = 2; d * d <= number; ++d) if (number % d === 0) prime = false;
    if (!prime) continue;
    if (found < 8) start[found] = root_bits(number, 2);
    constants[found++] = root_bits(number, 3);
}

const turn = (word, bits) => (word >>> bits) | (word << (32 - bits));

export class Sha256 {
    #state = start.slice();
    #block = new Uint8Array(64);
    #held = 0;
    #bytes = 0;
    #schedule = new Int32Array(64);

    /** Takes a Uint8Array. */
    add(data) {
        this.#bytes += data.length;
        let at = 0;
        if (this.#held > 0) {
            at = Math.min(64 - this.#held, data.length);
            this.#block.set(data.subarray(0, at), this.#held);
            this.#held += at;
            if (this.#held < 64) return this;
            this.#mix(this.#block, 0);
            this.#held = 0;
        }
        for (; at + 64 <= data.length; at += 64) this.#mix(data, at);
        this.#block.set(data.subarray(at));
        this.#held = data.length - at;
        return this;
    }

    /** 64 hexadecimal digits; nothing can be added afterwards. */
    hex() {
        const bits = BigInt(this.#bytes) * 8n;
        const end = new Uint8Array((this.#held < 56 ? 56 : 120) - this.#held + 8);
        end[0] = 0x80;
        new DataView(end.buffer).setBigUint64(end.length - 8, bits);
        this.add(end);
        return Array.from(this.#state, word => word.toString(16).padStart(8, '0')).join('');
    }

    #mix(data, at) {
        const w = this.#schedule;
        for (let i = 0; i < 16; ++i, at += 4)
            w[i] = (data[at] << 24) | (data[at + 1] << 16) | (data[at + 2] << 8) | data[at + 3];
        for (let i = 16; i < 64; ++i) {
            const x = w[i - 15];
            const y = w[i - 2];
            const s0 = turn(x, 7) ^ turn(x, 18) ^ (x >>> 3);
            const s1 = turn(y, 17) ^ turn(y, 19) ^ (y >>> 10);
            w[i] = (w[i - 16] + s0 + w[i - 7] + s1) | 0;
        }
        let [a, b, c, d, e, f, g, h] = this.#state;
        for (let i = 0; i < 64; ++i) {
            const t1 = (h + (turn(e, 6) ^ turn(e, 11) ^ turn(e, 25)) + ((e & f) ^ (~e & g)) + constants[i] + w[i]) | 0;
            const t2 = ((turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) + ((a & b) ^ (a & c) ^ (b & c))) | 0;
            h = g;
            g = f;
            f = e;
            e = (d + t1) | 0;
            d = c;
            c = b;
            b = a;
            a = (t1 + t2) | 0;
        }
        const sums = [a, b, c, d, e, f, g, h];
        for (let i = 0; i < 8; ++i) this.#state[i] += sums[i];
    }
}
