// validate.mjs FILE.glb...: the Khronos validator's findings as JSON, by file: { errors, warnings, infos, hints, messages }.
import { readFileSync } from "node:fs";
import validator from "gltf-validator";

const report = {};
for (const path of process.argv.slice(2)) {
    const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(path)), { uri: path, maxIssues: 100 });
    report[path] = {
        errors: issues.numErrors, warnings: issues.numWarnings, infos: issues.numInfos, hints: issues.numHints,
        messages: issues.messages.map((m) => `${m.code} ${m.pointer}: ${m.message}`),
    };
}
console.log(JSON.stringify(report));
