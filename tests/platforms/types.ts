// The TypeScript example of the package, and calls that its types must refuse.
import { Scene } from "three";
import { load, type PliantAsset, PliantError, type SolveInfo } from "pliant";
import { PliantMesh } from "pliant/three";

export async function play(bytes: ArrayBuffer, scene: Scene): Promise<SolveInfo> {
  const pliant = await load({ wasm: new URL("pliant.wasm", "file:///") });
  const asset: PliantAsset = pliant.open(bytes);
  const mesh = new PliantMesh(asset);
  scene.add(mesh);
  try {
    const names: string[] = asset.weights.map((weight) => weight.name);
    mesh.setWeights(new Float32Array(names.length));
    return mesh.setWeights({ smile: 1, blink: 0.5 });
  } catch (error) {
    if (error instanceof PliantError) console.log(error.result);
    throw error;
  } finally {
    mesh.dispose();
    asset.dispose();
  }
}

export function wrong(asset: PliantAsset): void {
  // @ts-expect-error: weights are numbers
  asset.character().solve(["smile"]);
  // @ts-expect-error: counts cannot be set
  asset.vertexCount = 3;
  // @ts-expect-error: an asset is opened, not made
  new (asset.constructor as typeof PliantAsset)();
}
