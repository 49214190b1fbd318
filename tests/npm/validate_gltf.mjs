// Runs Khronos' glTF validator over a file and prints its report as JSON. Usage: validate_gltf.mjs FILE.glb
import {readFileSync} from 'node:fs';
import validator from 'gltf-validator';

const report = await validator.validateBytes(new Uint8Array(readFileSync(process.argv[2])));
console.log(JSON.stringify(report));
