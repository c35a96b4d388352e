/**
 * Pliant in the browser and in node: elastic blends of a baked .pliant asset.
 *
 * One WebAssembly module of 100 KB; it fetches its own file and nothing else. Everything is synchronous after load().
 * Memory is that of the module: call dispose() when an asset or a character is no longer used. An asset must outlive its
 * characters. Every call with a wrong value throws PliantError, with an argument of a wrong type TypeError, and changes
 * nothing.
 */

/** The library, loaded. */
export interface Pliant {
  /** major * 10000 + minor * 100 + patch */
  readonly version: number;
  /**
   * Opens an asset: the bytes of a .pliant file, or of a GLB that `pliant export --embed` wrote. They are copied, and all
   * checksums are compared. Any bytes are safe. Throws PliantError if they are no asset.
   */
  open(data: ArrayBuffer | ArrayBufferView): PliantAsset;
}

/** Loads the WebAssembly module: `wasm` is its address (default: beside this file), its bytes, or the compiled module. */
export function load(options?: { wasm?: string | URL | ArrayBuffer | ArrayBufferView | WebAssembly.Module }): Promise<Pliant>;

/** `result`: the number of the C library's pliant_result, if it refused something. */
export class PliantError extends Error {
  readonly result: number | undefined;
}

/** A weight of a blend: its name, the range that the baker has measured, and the weight to start with. */
export interface Weight {
  readonly name: string;
  readonly low: number;
  readonly high: number;
  readonly initial: number;
}

/** One number for each weight in their order, or numbers by name; those that are not named are 0. */
export type Weights = readonly number[] | Float32Array | Float64Array | Readonly<Record<string, number>>;

/** An opened asset. */
export class PliantAsset {
  private constructor();
  readonly vertexCount: number;
  /** Vertices on the surface; the first ones. Fewer than vertexCount for a solid only. */
  readonly surfaceVertexCount: number;
  readonly triangleCount: number;
  /** Number of reduced coordinates. */
  readonly dimension: number;
  readonly poseCount: number;
  /** Weights add layers to pose 0, any numbers; otherwise a blend is an average of the poses, weights are not negative. */
  readonly hasLayers: boolean;
  readonly weights: readonly Weight[];
  /** Vertex indices, three for each triangle: a copy. */
  triangles(): Uint32Array;
  poseName(pose: number): string;
  /** The coordinates that reproduce a pose: a copy. */
  poseCoordinates(pose: number): Float32Array;
  /** A new character, at the initial weights. */
  character(): PliantCharacter;
  dispose(): void;
}

/** How a frame was solved: see pliant_solve_info in pliant.h. */
export interface SolveInfo {
  readonly status: "converged" | "limit" | "stalled";
  readonly iterations: number;
  readonly evaluations: number;
  readonly energy: number;
  readonly gradient: number;
  /** How far weights of layers are outside of their ranges; 0 inside. */
  readonly outside: number;
}

/** One character: its solver, positions and normals. */
export class PliantCharacter {
  private constructor();
  /** Blends elastically; positions and normals are then those of the blend. */
  solve(weights: Weights): SolveInfo;
  /** The weighted sum of the poses, as morph targets have it, for comparison. */
  solveLinear(weights: Weights): void;
  /**
   * x y z of every vertex: a view of the module's memory. Read the property again after an asset was opened or a character
   * made; the view is worth nothing after dispose().
   */
  readonly positions: Float32Array;
  /** The same for the vertices on the surface, of length 1. */
  readonly normals: Float32Array;
  /** The reduced coordinates of the blend: a view, too. */
  readonly coordinates: Float32Array;
  /** A box that holds the blend, without looking at the vertices. */
  bounds(): { low: [number, number, number]; high: [number, number, number] };
  /** For cuts and teleports: the next frame starts anew. */
  reset(): void;
  dispose(): void;
}
