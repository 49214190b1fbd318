// {request, edit} as JSON from standard input; prints the request that the viewer makes of them.
import { readFileSync } from 'node:fs';
import { compose_request } from '../../../clients/web/viewer/lighting_edit.js';

const { request, edit } = JSON.parse(readFileSync(0, 'utf8'));
console.log(JSON.stringify(compose_request(request, edit)));
