// Pliant for JavaScript: the C runtime as WebAssembly. pliant.d.ts is the manual.

const OK = 0, ERROR_ARGUMENT = 10, ERROR_WEIGHT_NOT_FINITE = 40, ERROR_WEIGHT_NEGATIVE = 41, ERROR_WEIGHT_SUM = 42;
const VERIFY_CHECKSUMS = 1;
const STATUS = ["converged", "limit", "stalled"];
const ALIGNMENT = 16;
const WEIGHTS_EXPECTED = "weights are numbers in order, or by name";

// JavaScript would take "1", true and null for numbers, and undefined for NaN.
const numberOf = (value) => {
  if (typeof value === "number") return value;
  throw new TypeError(WEIGHTS_EXPECTED);
};

export class PliantError extends Error {
  constructor(message, result) {
    super(message);
    this.name = "PliantError";
    this.result = result;
  }
}

// A block of the module's memory. Views are made anew when they are asked for, since the memory moves when it grows.
class Block {
  #at;

  constructor(module, size) {
    this.module = module;
    this.size = size;
    // i32 of WebAssembly are signed, and 4 GiB would be taken for 0.
    this.start = size + ALIGNMENT < 2 ** 32 ? module.exports.malloc(size + ALIGNMENT) >>> 0 : 0;
    if (this.start === 0) throw new PliantError(`no memory for ${size} bytes`, undefined);
    this.#at = this.start + (ALIGNMENT - (this.start % ALIGNMENT)) % ALIGNMENT;
  }

  check() {
    if (this.start === 0) throw new PliantError("used after dispose()", ERROR_ARGUMENT);
  }

  // Its address. Nobody gets that of a block that is free, so no call into the module writes there.
  get at() {
    this.check();
    return this.#at;
  }

  get buffer() { return this.module.exports.memory.buffer; }

  bytes() { return new Uint8Array(this.buffer, this.at, this.size); }
  floats() { return new Float32Array(this.buffer, this.at, this.size >> 2); }
  view() { return new DataView(this.buffer, this.at, this.size); }

  free() {
    if (this.start !== 0) this.module.exports.free(this.start);
    this.start = 0;
  }
}

function textAt(module, at) {
  const bytes = new Uint8Array(module.exports.memory.buffer, at >>> 0);
  return new TextDecoder("utf-8", { ignoreBOM: true }).decode(bytes.slice(0, bytes.indexOf(0)));
}

function require(module, result) {
  if (result !== OK) throw new PliantError(textAt(module, module.exports.pliant_result_text(result)), result);
}

// The bytes of the asset itself: all of a .pliant file, a part of a GLB.
function assetRange(module, blob) {
  const isGlb = blob.size >= 4 && blob.view().getUint32(0, true) === 0x46546c67;
  if (!isGlb) return { offset: 0, size: blob.size };
  const found = new Block(module, 8);
  try {
    require(module, module.exports.pliant_glb_find(blob.at, blob.size, found.at, found.at + 4));
    return { offset: found.view().getUint32(0, true), size: found.view().getUint32(4, true) };
  } finally {
    found.free();
  }
}

function bytesOf(data) {
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new TypeError("an asset is an ArrayBuffer or a typed array");
}

function weightsOf(module, view) {
  const count = module.exports.pliant_asset_get_weight_count(view.at), weight = new Block(module, 16), weights = [];
  for (let i = 0; i < count; ++i) {
    require(module, module.exports.pliant_asset_weight(view.at, i, weight.at));
    const fields = weight.view();
    weights.push(Object.freeze({
      name: textAt(module, fields.getUint32(0, true)),
      low: fields.getFloat32(4, true),
      high: fields.getFloat32(8, true),
      initial: fields.getFloat32(12, true),
    }));
  }
  weight.free();
  return Object.freeze(weights);
}

export class PliantAsset {
  #module;
  #blob;
  #view;

  constructor(module, data) {
    const bytes = bytesOf(data), exports = module.exports;
    this.#module = module;
    try {
      this.#blob = new Block(module, bytes.length);
      this.#view = new Block(module, exports.pliant_asset_size());
      this.#blob.bytes().set(bytes);
      const { offset, size } = assetRange(module, this.#blob);
      this.#blob.bytes().copyWithin(0, offset, offset + size); // glTF aligns what it holds to 4 bytes only
      require(module, exports.pliant_asset_open(this.#view.at, this.#blob.at, size, VERIFY_CHECKSUMS));
      this.#describe();
    } catch (error) {
      this.dispose();
      throw error;
    }
  }

  #describe() {
    const exports = this.#module.exports, at = this.#view.at;
    this.vertexCount = exports.pliant_asset_get_vertex_count(at);
    this.surfaceVertexCount = exports.pliant_asset_get_boundary_vertex_count(at);
    this.triangleCount = exports.pliant_asset_get_triangle_count(at);
    this.dimension = exports.pliant_asset_get_dimension(at);
    this.poseCount = exports.pliant_asset_get_pose_count(at);
    this.hasLayers = exports.pliant_asset_get_has_layers(at) === 1;
    this.weights = weightsOf(this.#module, this.#view);
    Object.freeze(this); // blocks of characters have these sizes
  }

  /** @internal */
  get parts() {
    this.#view.check();
    return { module: this.#module, view: this.#view };
  }

  triangles() {
    const { module, view } = this.parts;
    const at = module.exports.pliant_asset_get_triangles(view.at) >>> 0;
    return new Uint32Array(module.exports.memory.buffer, at, 3 * this.triangleCount).slice();
  }

  poseName(pose) {
    const { module, view } = this.parts;
    this.#checkPose(pose);
    return textAt(module, module.exports.pliant_asset_pose_name(view.at, pose));
  }

  poseCoordinates(pose) {
    const { module, view } = this.parts;
    this.#checkPose(pose);
    const at = module.exports.pliant_asset_pose_coordinates(view.at, pose) >>> 0;
    return new Float32Array(module.exports.memory.buffer, at, this.dimension).slice();
  }

  #checkPose(pose) {
    if (Number.isInteger(pose) && pose >= 0 && pose < this.poseCount) return;
    throw new PliantError(`there is no pose ${pose}`, ERROR_ARGUMENT);
  }

  // Weights as numbers in order, or by name; those that are not named are 0.
  weightsFrom(weights) {
    if (Array.isArray(weights) || ArrayBuffer.isView(weights)) {
      const count = weights.length ?? 0; // a DataView has none
      if (count === this.weights.length) return Float32Array.from({ length: count }, (_, i) => numberOf(weights[i]));
      throw new PliantError(`${count} weights given, the asset has ${this.weights.length}`, ERROR_ARGUMENT);
    }
    if (typeof weights !== "object" || weights === null || Symbol.iterator in weights)
      throw new TypeError(WEIGHTS_EXPECTED);
    const out = new Float32Array(this.weights.length);
    for (const [name, value] of Object.entries(weights)) {
      const index = this.weights.findIndex((weight) => weight.name === name);
      if (index < 0) {
        const known = this.weights.map((weight) => weight.name).join(", ");
        throw new PliantError(`there is no weight '${name}'; the weights are ${known}`, ERROR_ARGUMENT);
      }
      out[index] = numberOf(value);
    }
    return out;
  }

  character() { return new PliantCharacter(this); }

  dispose() {
    this.#view?.free();
    this.#blob?.free();
  }
}

export class PliantCharacter {
  #asset;
  #module;
  #view; // of the asset
  #blocks = {};
  #solver;

  constructor(asset) {
    if (!(asset instanceof PliantAsset)) throw new TypeError("a character is made of an asset");
    const { module, view } = asset.parts;
    this.#asset = asset;
    this.#module = module;
    this.#view = view;
    try {
      this.#allocate(module.exports);
      this.#initialize(module.exports);
      this.solve(asset.weights.map((weight) => weight.initial));
    } catch (error) {
      this.dispose();
      throw error;
    }
  }

  #allocate(exports) {
    const at = this.#view.at, block = (name, size) => (this.#blocks[name] = new Block(this.#module, size));
    block("desc", 64);
    exports.pliant_solver_desc_init(this.#blocks.desc.at);
    block("solver", exports.pliant_solver_memory(at, this.#blocks.desc.at));
    block("out", 4);
    block("info", 24);
    block("weights", 4 * exports.pliant_asset_get_weight_count(at));
    block("coordinates", 4 * exports.pliant_asset_get_dimension(at));
    block("positions", 12 * exports.pliant_asset_get_vertex_count(at));
    block("normals", 12 * exports.pliant_asset_get_boundary_vertex_count(at));
    block("normalsView", exports.pliant_normals_size());
    block("normalsMemory", exports.pliant_normals_memory(at));
    block("box", 24);
  }

  #initialize(exports) {
    const { desc, solver, out, normalsView, normalsMemory } = this.#blocks;
    require(this.#module, exports.pliant_solver_init(out.at, this.#view.at, desc.at, solver.at, solver.size));
    this.#solver = out.view().getUint32(0, true);
    require(this.#module,
            exports.pliant_normals_init(normalsView.at, this.#view.at, normalsMemory.at, normalsMemory.size));
  }

  solve(weights) {
    const exports = this.#module.exports, { info, coordinates } = this.#blocks, given = this.#blocks.weights;
    const numbers = this.#asset.weightsFrom(weights); // may run code of the caller, which may dispose of us
    this.#view.check();
    given.floats().set(numbers);
    require(this.#module, exports.pliant_solve(this.#solver, given.at, coordinates.at, info.at));
    this.#rebuild();
    const fields = info.view();
    return {
      status: STATUS[fields.getUint32(0, true)],
      iterations: fields.getUint32(4, true),
      evaluations: fields.getUint32(8, true),
      energy: fields.getFloat32(12, true),
      gradient: fields.getFloat32(16, true),
      outside: fields.getFloat32(20, true),
    };
  }

  // What engines do without Pliant: the weighted sum of the poses.
  solveLinear(weights) {
    const asset = this.#asset, given = asset.weightsFrom(weights);
    const sum = given.reduce((a, b) => a + b, 0);
    if (!given.every(Number.isFinite)) require(this.#module, ERROR_WEIGHT_NOT_FINITE);
    if (!asset.hasLayers && given.some((weight) => weight < 0)) require(this.#module, ERROR_WEIGHT_NEGATIVE);
    if (!asset.hasLayers && sum === 0) require(this.#module, ERROR_WEIGHT_SUM);
    const q = new Float64Array(asset.dimension);
    const add = (pose, share) => share !== 0 && asset.poseCoordinates(pose).forEach((c, i) => { q[i] += share * c; });
    if (asset.hasLayers) add(0, 1 - sum);
    given.forEach((value, k) => add(asset.hasLayers ? k + 1 : k, asset.hasLayers ? value : value / sum));
    this.#blocks.coordinates.floats().set(q);
    this.#rebuild();
  }

  #rebuild() {
    this.#view.check();
    const exports = this.#module.exports, { coordinates, positions, normals, normalsView } = this.#blocks;
    exports.pliant_reconstruct(this.#view.at, coordinates.at, 0, positions.size / 12, positions.at, 12);
    exports.pliant_normals_compute(normalsView.at, positions.at, 12, 0, normals.size / 12, normals.at, 12);
  }

  get positions() { return this.#blocks.positions.floats(); }
  get normals() { return this.#blocks.normals.floats(); }
  get coordinates() { return this.#blocks.coordinates.floats(); }

  bounds() {
    const { box, coordinates } = this.#blocks;
    require(this.#module,
            this.#module.exports.pliant_bounds(this.#view.at, coordinates.at, box.at, box.at + 12));
    const numbers = Array.from(box.floats());
    return { low: numbers.slice(0, 3), high: numbers.slice(3) };
  }

  reset() {
    this.#blocks.solver.check();
    this.#module.exports.pliant_solver_reset(this.#solver);
  }

  dispose() { for (const block of Object.values(this.#blocks)) block.free(); }
}

// Bundlers for pages do not know node's modules. The name is a parameter, since they look for literals.
const readInNode = async (url, name = "node:fs/promises") =>
  (await import(/* webpackIgnore: true */ /* @vite-ignore */ name)).readFile(url);

async function compiled(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer) return WebAssembly.compile(source);
  if (ArrayBuffer.isView(source)) // V8 refuses a DataView
    return WebAssembly.compile(new Uint8Array(source.buffer, source.byteOffset, source.byteLength));
  if (typeof source !== "string" && !(source instanceof URL)) throw new TypeError("wasm is neither an address, bytes nor a module");
  const url = new URL(/* webpackIgnore: true */ source, import.meta.url);
  if (url.protocol === "file:" && globalThis.process?.versions?.node) return WebAssembly.compile(await readInNode(url));
  const response = await fetch(url);
  if (!response.ok) throw new PliantError(`${url} cannot be fetched: ${response.status}`, undefined);
  return WebAssembly.compile(await response.arrayBuffer());
}

export async function load({ wasm = "./pliant.wasm" } = {}) {
  const instance = await WebAssembly.instantiate(await compiled(wasm), {});
  instance.exports._initialize();
  const module = { exports: instance.exports };
  return { version: instance.exports.pliant_version(), open: (data) => new PliantAsset(module, data) };
}
