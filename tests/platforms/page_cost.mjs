// node page_cost.mjs BROWSER PAGE: what `character.pliant` in the folder PAGE costs in the page of samples/web, for
// page_cost.py: one character on the page itself, then 20 of them, each with its own weights in every frame.
import { launch, open, serve } from "./tab.mjs";

const [browserPath, folder] = process.argv.slice(2), CROWD = 20, FRAMES = 120;

// Medians in milliseconds: the processor's part (solve, positions, normals, bounds) of all characters, and a whole frame with
// the drawing of one picture.
function measure(tab, count) {
  return tab.evaluate(async (characters, frames) => {
    const { PliantMesh } = await import("pliant/three"), { view, page } = window, { asset } = page;
    const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
    const meshes = Array.from({ length: characters }, () => new PliantMesh(asset, view.material));
    meshes.forEach((mesh, i) => mesh.position.set((i % 5 - 2) * view.diagonal / 4, 0, -Math.floor(i / 5) * view.diagonal / 4));
    for (const mesh of view.meshes) mesh.visible = false;
    view.scene.add(...meshes);
    const blends = [], whole = [];
    for (let frame = 0, last = 0; frame < frames; ++frame) {
      const now = await new Promise(requestAnimationFrame);
      if (last > 0) whole.push(now - last);
      last = now;
      const start = performance.now();
      meshes.forEach((mesh, i) => mesh.setWeights(asset.weights.map(({ high }, k) =>
        high * (0.5 + 0.5 * Math.sin(frame / 20 + 2 * k + 3 * i)) + 0.01)));
      blends.push(performance.now() - start);
      view.renderer.render(view.scene, view.camera);
    }
    for (const mesh of meshes) {
      view.scene.remove(mesh);
      mesh.dispose();
    }
    return { blend: median(blends), frame: median(whole), about: document.getElementById("about").textContent };
  }, count, FRAMES);
}

const { server, port } = await serve(folder), browser = await launch(browserPath);
try {
  const tab = await browser.newPage();
  await tab.setViewport({ width: 1280, height: 800 });
  await open(tab, port, "#file=character.pliant");
  for (const count of [1, CROWD]) {
    const { blend, frame, about } = await measure(tab, count);
    if (count === 1) console.log(`${about}\n${await browser.version()}`);
    console.log(`${count} on the page: ${blend.toFixed(2)} ms of the processor, ${frame.toFixed(1)} ms a frame with the drawing`);
  }
} finally {
  await browser.close();
  server.close();
}
