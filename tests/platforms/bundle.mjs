// node bundle.mjs MODULES PROJECT: programs that esbuild and webpack make of the installed package load their module.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, project] = process.argv.slice(2);
const require = createRequire(join(modules, "package.json")), esbuild = require("esbuild"), webpack = require("webpack");
const entry = join(project, "bundle.js"), inside = (...names) => join(project, ...names);

writeFileSync(entry, `import { load } from "pliant";
console.log((await load({ wasm: new URL("pliant/pliant.wasm", import.meta.url) })).version);\n`);

for (const minify of [false, true]) {
  const outfile = inside(`esbuild_${minify}`, "main.mjs");
  esbuild.buildSync({ entryPoints: [entry], bundle: true, minify, format: "esm", target: "es2022", outfile });
  cpSync(inside("node_modules/pliant/pliant.wasm"), inside(`esbuild_${minify}`, "pliant/pliant.wasm"));
  check(outfile);
}

for (const mode of ["development", "production"]) {
  const path = inside(`webpack_${mode}`), output = { path, filename: "main.cjs", publicPath: `${pathToFileURL(path)}/` };
  const plugins = [new webpack.BannerPlugin({ banner: "globalThis.self = { location: new URL('file:///page') };", raw: true })];
  await new Promise((done) => webpack({ mode, context: project, entry, output, plugins }, (error, stats) => {
    assert.ok(!error && !stats.hasErrors() && !stats.hasWarnings(), error?.message ?? stats.toString());
    done();
  }));
  check(join(path, "main.cjs"));
}

function check(program) {
  assert.match(execFileSync(process.execPath, [program], { encoding: "utf8" }), /^\d+\n$/, program);
}
