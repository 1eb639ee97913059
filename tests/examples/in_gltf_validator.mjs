// Print the report of Khronos' glTF validator on a file, as JSON.
//
//     node in_gltf_validator.mjs NODE_MODULES FILE

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [modules, file] = process.argv.slice(2);
const validator = createRequire(modules + "/")("gltf-validator");
const report = await validator.validateBytes(new Uint8Array(readFileSync(file)));
console.log(JSON.stringify(report.issues));
