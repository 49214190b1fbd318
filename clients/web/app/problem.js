// A failed request to the service, with a message for the user.
import { wait_ms_of } from './retry.js';

export class Problem extends Error {
    /**
     * status: HTTP status, 0 when the service could not be reached;
     * field: the request's field that is wrong, or '';
     * needed_by: what refers to an input that is not deleted, as the service lists it, or null;
     * wait_ms: the wait that the service asks for before the next try, or 0.
     */
    constructor(status, message, { field = '', needed_by = null, wait_ms = 0 } = {}) {
        super(message);
        this.status = status;
        this.field = field;
        this.needed_by = needed_by;
        this.wait_ms = wait_ms;
    }
}

/** The Problem of a reply with an error status. */
export async function problem_of(reply) {
    let body = {};
    try {
        body = await reply.json();
    } catch {
        // The error page of a proxy is not JSON: only the status is known.
    }
    return new Problem(reply.status, body.detail || `The service answered ${reply.status}.`, {
        field: body.field || '',
        needed_by: body.needed_by ?? null,
        wait_ms: wait_ms_of(reply.headers.get('Retry-After')),
    });
}
