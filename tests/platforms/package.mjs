// node package.mjs PACKAGE ASSETS GOLDEN MUSEUM: the npm package on the small assets of tests/runtime, on those of
// tests/golden and on the museum of bad files. Prints the hashes that test_bits.c prints, of the same blends; fails with a
// message where something is wrong.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, assets, golden, museum] = process.argv.slice(2);
const { load, PliantError } = await import(pathToFileURL(join(folder, "pliant.js")));
await load({ wasm: new DataView(new Uint8Array(readFileSync(join(folder, "pliant.wasm"))).buffer) });
for (const wasm of [null, 5, Promise.resolve("pliant.wasm")]) await assert.rejects(load({ wasm }), TypeError);
const pliant = await load();
const bytesOf = (name) => readFileSync(join(assets, `${name}.pliant`));

// -- the bits of test_bits.c: random numbers and weights as tests/runtime/support.h makes them

const f = Math.fround, mask = (1n << 64n) - 1n;

function randomBits(state) {
  let s = state.bits;
  s ^= s >> 12n;
  s = (s ^ (s << 25n)) & mask;
  s ^= s >> 27n;
  state.bits = s;
  return (s * 2685821657736338717n) & mask;
}

const randomUnit = (state) => Number(randomBits(state) >> 40n) / 16777216;
const randomBelow = (state, limit) => Number((randomBits(state) >> 32n) % BigInt(limit));

function randomBlend(state, asset) {
  const count = asset.weights.length;
  const weights = Float32Array.from({ length: count }, () => f(randomUnit(state) + f(1e-6)));
  for (let k = 0; asset.hasLayers && k < count; ++k) {
    weights[k] = f(f(f(1.4) * weights[k]) - f(0.4));
    if (randomBelow(state, count) >= 3) weights[k] = 0;
  }
  return weights;
}

const START = 14695981039346656037n, words = (hash) => hash.toString(16).padStart(16, "0");

const hashed = (hash, floats) => new Uint32Array(Float32Array.from(floats).buffer)
  .reduce((sum, word) => ((sum ^ BigInt(word)) * 1099511628211n) & mask, hash);

function printBlend(name, asset, character, first) {
  const listed = first.slice(0, asset.weights.length);
  character.reset();
  character.solve(asset.weights.map((_, k) => listed[k] ?? 0));
  const { positions, normals } = character;
  console.log(`${name} ${listed} ${words(hashed(START, positions.slice(0, normals.length)))} ${words(hashed(START, normals))}`);
}

function printWalk(name, asset, character) {
  const state = { bits: 61n };
  let weights, hash = START;
  character.reset();
  for (let frame = 0; frame < 30; ++frame) {
    if (frame % 6 === 0) weights = randomBlend(state, asset);
    const k = frame % weights.length;
    weights[k] = f(weights[k] + f(0.03));
    const info = character.solve(weights), { coordinates, positions, normals } = character;
    for (const floats of [coordinates, [info.energy], [...positions, ...normals].slice(0, 24), normals])
      hash = hashed(hash, floats);
  }
  console.log(`${name} walk ${words(hash)}`);
}

function printFolder(folder) {
  for (const name of readFileSync(join(folder, "assets.txt"), "utf8").split(/\s+/).filter((text) => text)) {
    const asset = pliant.open(readFileSync(join(folder, `${name}.pliant`))), character = asset.character();
    for (const first of [[1], [0.5, 0.5, 0.5], [0.25, 0.5, 0.75]]) printBlend(name, asset, character, first);
    printWalk(name, asset, character);
    character.dispose();
    asset.dispose();
  }
}

// -- errors

function refuses(call, result, text) {
  assert.throws(call, (error) => error instanceof PliantError && error.result === result && error.message.includes(text));
}

// More than a module has, where a system has it.
function checkHuge() {
  let huge;
  try {
    huge = new ArrayBuffer(2 ** 32 - 16);
  } catch {
    return;
  }
  refuses(() => pliant.open(huge), undefined, "no memory");
}

function checkErrors() {
  const asset = pliant.open(bytesOf("layers_mixed")), character = asset.character();
  const before = Float32Array.from(character.solve({ [asset.weights[0].name]: 0.5 }) && character.positions);
  refuses(() => character.solve([1]), 10, "1 weights given, the asset has 3");
  refuses(() => character.solve({ nose: 1 }), 10, "there is no weight 'nose'; the weights are pose 1, pose 2, pose 3");
  refuses(() => character.solve([NaN, 0, 0]), 40, "");
  refuses(() => character.solveLinear([NaN, 0, 0]), 40, "");
  refuses(() => asset.poseName(0.5), 10, "there is no pose 0.5");
  refuses(() => asset.poseName(99), 10, "there is no pose 99");
  refuses(() => asset.poseCoordinates(-1), 10, "there is no pose -1");
  assert.deepEqual(Float32Array.from(character.positions), before);
  assert.throws(() => pliant.open("a name"), TypeError);
  checkHuge();
  refuses(() => character.solve(new Array(2 ** 32 - 1)), 10, "4294967295 weights given, the asset has 3");
  refuses(() => character.solve(new DataView(new ArrayBuffer(12))), 10, "0 weights given, the asset has 3");
  const fickle = Object.assign([0, 0, 0], { *[Symbol.iterator]() { for (;;) yield 1; } });
  assert.deepEqual(Float32Array.from(character.solve(fickle)), Float32Array.from(character.solve([0, 0, 0])));
  const wrong = [5, null, "abc", new Map([["pose 1", 1]]), ["1", 0, 0], [true, 0, 0], [1, , 0], { [asset.weights[0].name]: "1" }];
  for (const weights of wrong) assert.throws(() => character.solve(weights), TypeError);
  refuses(() => pliant.open(new ArrayBuffer(0)), 20, "");
  const lookalike = { parts: asset.parts, weights: asset.weights, dimension: 1, vertexCount: 1, surfaceVertexCount: 1 };
  assert.throws(() => new character.constructor(lookalike), TypeError);
  character.dispose();
  character.dispose();
  for (const call of [() => character.solve([0, 0, 0]), () => character.positions, () => character.bounds(), () => character.reset()])
    refuses(call, 10, "used after dispose()");
  asset.dispose();
  for (const call of [() => asset.triangles(), () => asset.character()]) refuses(call, 10, "used after dispose()");
  const other = pliant.open(bytesOf("strip_neo")), left = other.character();
  refuses(() => left.solveLinear([-1, 2]), 41, "");
  refuses(() => left.solveLinear([0, 0]), 42, "");
  other.dispose();
  refuses(() => left.solve([1, 1]), 10, "used after dispose()");
  left.dispose();
}

// glTF promises the file's parts multiples of 4 only.
function checkEmbedded() {
  const asset = bytesOf("strip_neo");
  for (let pad = 0; pad < 4; ++pad) {
    const json = "{}".padEnd(64 + 4 * pad), glb = Buffer.alloc(28 + json.length + asset.length);
    [0x46546c67, 2, glb.length, json.length, 0x4e4f534a].forEach((word, i) => glb.writeUInt32LE(word, 4 * i));
    glb.write(json, 20);
    [asset.length, 0x004e4942].forEach((word, i) => glb.writeUInt32LE(word, 20 + json.length + 4 * i));
    asset.copy(glb, 28 + json.length);
    assert.equal(pliant.open(glb).poseCount, pliant.open(asset).poseCount);
  }
}

function checkMuseum() {
  let count = 0;
  for (const name of readdirSync(museum).filter((file) => file.endsWith(".pliant"))) {
    try {
      pliant.open(readFileSync(join(museum, name))).dispose();
    } catch (error) {
      assert.ok(error instanceof PliantError && error.result >= 20, `${name}: ${error}`);
      ++count;
    }
  }
  assert.ok(count > 300, `only ${count} bad files were refused`);
}

// A million frames would not need more memory than one.
function checkMemory() {
  const cycle = () => {
    const asset = pliant.open(bytesOf("strip_factored")), character = asset.character();
    character.solve(asset.weights.map(() => 0.5));
    const size = character.positions.buffer.byteLength;
    character.dispose();
    asset.dispose();
    return size;
  };
  const first = cycle();
  for (let i = 0; i < 2000; ++i) assert.equal(cycle(), first);
}

[assets, golden].forEach(printFolder);
checkErrors();
checkEmbedded();
checkMuseum();
checkMemory();
