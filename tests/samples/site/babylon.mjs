// node babylon.mjs FILE.glb WEIGHTS: loads a file of `pliant export` with the recipe of the page, on Babylon.js without a
// screen. Prints the positions of the mesh for the weights (JSON), and morph weights at two times of its animation.
import { readFileSync } from "node:fs";
import { NullEngine } from "@babylonjs/core/Engines/nullEngine.js";
import { Scene } from "@babylonjs/core/scene.js";
import { loadPliant } from "./recipe.mjs";

const [path, weights] = process.argv.slice(2);
const scene = new Scene(new NullEngine());
const bytes = new Uint8Array(readFileSync(path));
const { meshes, setWeights } = await loadPliant(bytes, scene);
const mesh = meshes.find((each) => each.morphTargetManager);
const influences = () => Array.from({ length: mesh.morphTargetManager.numTargets },
  (_, j) => mesh.morphTargetManager.getTarget(j).influence);

const [group] = scene.animationGroups;
const played = [0, 0.1].map((part) => {
  group.start(true);
  group.goToFrame(group.from + part * (group.to - group.from));
  return influences();
});
group.stop();
setWeights(JSON.parse(weights));
console.log(`REPORT ${JSON.stringify({ played, set: influences(), positions: [...mesh.getPositionData(false, true)] })}`);
process.exit(0);
