// Requests to the service. Each failure is thrown as a Problem.
import { Problem, problem_of } from './problem.js';
import { watch } from './watch.js';

export class Api {
    #on_locked;
    #contract = null;

    /** `on_locked` is called when the service demands a token. */
    constructor(on_locked) {
        this.#on_locked = on_locked;
    }

    /** The reply to a request; `options` are those of fetch. Throws Problem unless the status is 2xx or 304. */
    async ask(path, options = {}) {
        let reply;
        try {
            reply = await fetch(path, { credentials: 'same-origin', ...options });
        } catch (error) {
            if (options.signal?.aborted) throw error;
            throw new Problem(0, 'The service does not answer. It may have stopped, or the network is down.');
        }
        if (reply.ok || reply.status === 304) return reply;
        const problem = await problem_of(reply);
        if (problem.status === 401) this.#on_locked();
        throw problem;
    }

    async json(path, options) {
        return (await this.ask(path, options)).json();
    }

    post(path, object, query = '') {
        return this.#send('POST', path + query, object);
    }

    put(path, object) {
        return this.#send('PUT', path, object);
    }

    async remove(path) {
        return content_of(await this.ask(path, { method: 'DELETE' }));
    }

    file_url(bake, name) {
        return `/v1/bakes/${encodeURIComponent(bake)}/files/${encodeURIComponent(name)}`;
    }

    /** Fetches a document again and again, see watch.js. */
    watch(path, every_ms, on_value, on_problem, signal) {
        return watch(this.ask.bind(this), path, every_ms, on_value, on_problem, signal);
    }

    /** The request's schema and the presets: { schema, presets: [{ name, description, request }] }. */
    contract() {
        this.#contract ??= this.json('/openapi.json').then(contract_of);
        this.#contract.catch(() => (this.#contract = null)); // the next call tries again
        return this.#contract;
    }

    async #send(method, path, object) {
        const headers = { 'Content-Type': 'application/json' };
        return content_of(await this.ask(path, { method, headers, body: JSON.stringify(object) }));
    }
}

const content_of = reply => (reply.status === 204 ? null : reply.json());

function contract_of({ components }) {
    const presets = Object.entries(components.examples ?? {});
    return {
        schema: components.schemas.BakeRequest,
        presets: presets.map(([name, { summary, value }]) => ({ name, description: summary, request: value })),
    };
}
