/** Pliant for three.js: a mesh whose shape is an elastic blend. */
import type { BufferGeometry, Material } from "three";
import { Mesh } from "three";
import type { PliantAsset, SolveInfo, Weight, Weights } from "./pliant.js";

/** A mesh with the triangles of the asset; box and sphere for culling follow the blend. */
export class PliantMesh extends Mesh<BufferGeometry, Material | Material[]> {
  /** At the initial weights. The asset must outlive the mesh. Default: a new MeshStandardMaterial. */
  constructor(asset: PliantAsset, material?: Material | Material[]);
  readonly asset: PliantAsset;
  readonly weights: readonly Weight[];
  /** Blends elastically. */
  setWeights(weights: Weights): SolveInfo;
  /** The weighted sum of the poses, for comparison. */
  setLinearWeights(weights: Weights): void;
  /** Another character of the same asset, at the initial weights. */
  clone(recursive?: boolean): this;
  /** Frees the character and the geometry, not the material and the asset. */
  dispose(): void;
}
