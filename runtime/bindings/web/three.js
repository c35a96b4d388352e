// Pliant for three.js: a mesh whose shape is an elastic blend. three.d.ts is the manual.
import { Box3, BufferAttribute, BufferGeometry, DynamicDrawUsage, Mesh, MeshStandardMaterial, Sphere } from "three";

function dynamic(floats) {
  const attribute = new BufferAttribute(Float32Array.from(floats), 3);
  attribute.setUsage(DynamicDrawUsage);
  return attribute;
}

export class PliantMesh extends Mesh {
  #character;

  constructor(asset, material = new MeshStandardMaterial()) {
    const character = asset.character(), geometry = new BufferGeometry();
    geometry.setAttribute("position", dynamic(character.positions.subarray(0, 3 * asset.surfaceVertexCount)));
    geometry.setAttribute("normal", dynamic(character.normals));
    geometry.setIndex(new BufferAttribute(asset.triangles(), 1));
    geometry.boundingBox = new Box3();
    geometry.boundingSphere = new Sphere();
    super(geometry, material);
    this.asset = asset;
    this.#character = character;
    this.#update();
  }

  get weights() { return this.asset.weights; }

  setWeights(weights) {
    const info = this.#character.solve(weights);
    this.#update();
    return info;
  }

  setLinearWeights(weights) {
    this.#character.solveLinear(weights);
    this.#update();
  }

  #update() {
    const { position, normal } = this.geometry.attributes, { low, high } = this.#character.bounds();
    position.array.set(this.#character.positions.subarray(0, position.array.length));
    normal.array.set(this.#character.normals);
    position.needsUpdate = normal.needsUpdate = true;
    const { boundingBox, boundingSphere } = this.geometry;
    boundingBox.min.fromArray(low);
    boundingBox.max.fromArray(high);
    boundingBox.getBoundingSphere(boundingSphere);
  }

  clone(recursive) {
    const other = new PliantMesh(this.asset, this.material), { geometry } = other;
    other.copy(this, recursive);
    other.geometry = geometry; // copy() would share it
    return other;
  }

  dispose() {
    this.#character.dispose();
    this.geometry.dispose();
  }
}
