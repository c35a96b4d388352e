// node wasm.mjs PACKAGE MUTATOR.wasm SECONDS FOUND FILE...: mutations of assets through the npm package, as a page takes them:
// open, names, weights, triangles, a character with ordinary and odd weights, bounds, dispose. Every block of the module's
// memory has guards on both sides. Writes inputs that trap, touch a guard, or throw what is no PliantError into FOUND.
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, mutatorFile, seconds, found, ...files] = process.argv.slice(2);
const GUARD = 32, PATTERN = 0x5a, CAPACITY = 1 << 17, MUTATIONS = 4;

// -- malloc and free with guards. The block behind the first guard begins one byte off its alignment, so that pliant.js, which
// aligns it upward, has one byte to spare.

const BEFORE = GUARD + 1;
const sizes = new Map();
let memory;

function malloc(exports, size) {
  const start = exports.malloc(BEFORE + size + GUARD) >>> 0;
  if (start === 0) return 0;
  new Uint8Array(memory.buffer, start, BEFORE + size + GUARD).fill(PATTERN);
  sizes.set(start + BEFORE, size);
  return start + BEFORE;
}

function free(exports, at) {
  const start = (at >>> 0) - BEFORE, size = sizes.get(at >>> 0);
  if (size === undefined) throw new Error(`free of ${at}, which is no block`);
  sizes.delete(at >>> 0);
  const bytes = new Uint8Array(memory.buffer, start, BEFORE + size + GUARD);
  const isWhole = (part) => part.every((byte) => byte === PATTERN);
  const before = isWhole(bytes.subarray(0, BEFORE)), behind = isWhole(bytes.subarray(BEFORE + size));
  exports.free(start);
  if (!before || !behind) throw new Error(`a write beyond a block of ${size} bytes`);
}

const instantiate = WebAssembly.instantiate;
WebAssembly.instantiate = async (module, imports) => {
  const { exports } = await instantiate(module, imports);
  memory = exports.memory;
  const guarded = { malloc: (size) => malloc(exports, size), free: (at) => free(exports, at) };
  return { exports: { ...exports, ...guarded } };
};
const { load, PliantError } = await import(pathToFileURL(join(folder, "pliant.js")));
const pliant = await load();
WebAssembly.instantiate = instantiate;

// -- mutations by mutate_asset.c

const mutator = (await WebAssembly.instantiate(readFileSync(mutatorFile), {})).instance.exports;
mutator._initialize();
const work = mutator.malloc(CAPACITY), other = mutator.malloc(CAPACITY), crossed = mutator.malloc(CAPACITY);
const inputs = files.map((file) => readFileSync(file)).filter((bytes) => bytes.length > 0 && bytes.length < CAPACITY);
const put = (at, bytes) => new Uint8Array(mutator.memory.buffer, at, CAPACITY).set(bytes);

function mutated(count) {
  const input = inputs[count % inputs.length];
  let size = input.length, at = work;
  put(work, input);
  if (count % 16 === 12) {
    const second = inputs[(count * 7) % inputs.length];
    put(other, second);
    size = mutator.LLVMFuzzerCustomCrossOver(work, size, other, second.length, crossed, CAPACITY, count);
    at = crossed;
  }
  for (let i = 0; i <= count % MUTATIONS; ++i)
    size = mutator.LLVMFuzzerCustomMutator(at, size, CAPACITY, MUTATIONS * count + i);
  return new Uint8Array(mutator.memory.buffer, at, size).slice();
}

// -- what a page does

function attempt(action) {
  try {
    return action();
  } catch (error) {
    if (error instanceof PliantError) return undefined;
    throw error;
  }
}

const odd = [0, -0, 1, 1e-45, 3e38, -1, NaN, Infinity];

function use(asset, count) {
  for (let pose = 0; pose < asset.poseCount; ++pose) {
    asset.poseName(pose);
    if (asset.poseCoordinates(pose).length !== asset.dimension) throw new Error("coordinates of another length");
  }
  if (asset.triangles().some((vertex) => vertex >= asset.surfaceVertexCount)) throw new Error("a triangle out of range");
  const character = attempt(() => asset.character());
  if (!character) return;
  attempt(() => character.solve(asset.weights.map((_, i) => 1 + i / 8)));
  attempt(() => character.solve(asset.weights.map((_, i) => odd[(count + i) % odd.length])));
  attempt(() => character.solveLinear(asset.weights.map(() => 0.5)));
  attempt(() => character.bounds());
  character.reset();
  character.dispose();
}

function take(bytes, count) {
  const asset = attempt(() => pliant.open(bytes));
  if (!asset) return;
  use(asset, count);
  asset.dispose();
  if (sizes.size > 0) throw new Error(`${sizes.size} blocks are left`);
}

// Weights that dispose of the character while it reads them.
function disposeWithin(character, name, weights) {
  let before;
  const changing = Object.defineProperty([...weights], 0, { get() {
    character.dispose();
    before = new Uint8Array(memory.buffer).slice();
    return 1;
  } });
  const hasAnswered = attempt(() => (character[name](changing), true));
  if (hasAnswered || Buffer.compare(before, new Uint8Array(memory.buffer)) !== 0)
    throw new Error(`${name}() goes on with a character that its weights disposed of`);
}

// Nothing that a disposed character is asked for writes into memory, which may be another's by then.
function useDisposed() {
  const assets = inputs.map((bytes) => attempt(() => pliant.open(bytes))).filter((one) => one), asset = assets[0];
  const character = asset.character(), weights = asset.weights.map(() => 1);
  for (const name of ["solve", "solveLinear"]) disposeWithin(asset.character(), name, weights);
  character.dispose();
  const before = new Uint8Array(memory.buffer).slice();
  const calls = ["solve", "solveLinear", "bounds", "reset"].map((name) => () => character[name](weights));
  const answered = [...calls, () => character.positions].filter((call) => attempt(() => (call(), true)));
  const isSame = Buffer.compare(before, new Uint8Array(memory.buffer)) === 0;
  if (answered.length > 0 || !isSame) throw new Error("a disposed character is in use");
  for (const one of assets) one.dispose();
}

async function keep(bytes, error) {
  const name = join(found, createHash("sha256").update(bytes).digest("hex").slice(0, 12));
  mkdirSync(found, { recursive: true });
  writeFileSync(name, bytes);
  console.log(`${name}: ${error.stack}`);
  process.exitCode = 1;
  process.exit();
}

useDisposed();
const end = Date.now() + 1000 * Number(seconds), begin = Date.now();
let count = 0;
for (; Date.now() < end; ++count) {
  const bytes = mutated(count);
  try {
    take(bytes, count);
  } catch (error) {
    await keep(bytes, error);
  }
}
console.log(`stat::number_of_executed_units: ${count}`);
console.log(`stat::average_exec_per_sec: ${Math.round((1000 * count) / Math.max(1, Date.now() - begin))}`);
console.log(`memory: ${memory.buffer.byteLength} bytes`);
