// Reads a KTX 2.0 file with ktx-parse: its header and texts go to standard output as JSON, the bytes of its first level
// to a file. Usage: read_ktx2.mjs FILE.ktx2 LEVEL_FILE
import {readFileSync, writeFileSync} from 'node:fs';
import {read} from 'ktx-parse';

const [file, levelFile] = process.argv.slice(2);
const {levels, keyValue, globalData, ...header} = read(new Uint8Array(readFileSync(file)));
writeFileSync(levelFile, levels[0].levelData);
// ktx-parse gives the format's own keys as texts and others as bytes with their closing zero.
const text = value => typeof value === 'string' ? value : new TextDecoder().decode(value.subarray(0, -1));
const texts = Object.fromEntries(Object.entries(keyValue).map(([key, value]) => [key, text(value)]));
console.log(JSON.stringify({...header, levels: levels.length, texts}));
