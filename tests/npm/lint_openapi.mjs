// lint_openapi.mjs FILE: what redocly's recommended rules find in an OpenAPI document, a line each; exit code 1 then.
import { createConfig, lint } from '@redocly/openapi-core';

const config = await createConfig({ extends: ['recommended'] });
const found = await lint({ ref: process.argv[2], config });
for (const problem of found) {
  console.log(`${problem.severity} ${problem.ruleId} ${problem.location[0]?.pointer}: ${problem.message}`);
}
process.exit(found.length ? 1 : 0);
