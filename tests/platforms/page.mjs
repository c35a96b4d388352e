// node page.mjs BROWSER PAGE EXPECTED BAD PICTURE: the page of samples/web in a headless browser, as a person uses it. PAGE:
// a folder that its build.py made, with the assets `averages.pliant` and `layers.pliant`, and the first one in
// `embedded.glb`. EXPECTED: a JSON file with blends of both by the C library, { "averages": { "weights": [...],
// "positions": [...] }, ... }, and as "player" the path of the player's picture of the first. BAD: a file that is no asset.
// BROWSER: the program's path; Firefox is known by its name. PICTURE: where to keep a picture of the page.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { launch, open, serve, settled } from "./tab.mjs";

const [browserPath, folder, expectedPath, bad, picture] = process.argv.slice(2);
const expected = JSON.parse(readFileSync(expectedPath, "utf8"));
const textOf = (tab, id) => tab.$eval(`#${id}`, (element) => (element.hidden ? "" : element.textContent));

// The shape that is drawn is that of the C library, to the bit.
async function checkPositions(tab, name) {
  const found = await tab.evaluate(() => Array.from(window.view.elastic.geometry.attributes.position.array));
  assert.deepEqual(found, expected[name].positions, `${name}: other positions than the C library's`);
}

// How many pixels of the left and of the right half are not the background's.
async function drawnPixels(tab) {
  return tab.evaluate(async () => {
    await new Promise(requestAnimationFrame);
    window.view.draw();
    const { canvas } = window.view, copy = document.createElement("canvas");
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height), counts = [0, 0];
    for (let i = 0; i < data.length; i += 4)
      if (data[i + 3] > 0) ++counts[(i / 4) % copy.width < copy.width / 2 ? 0 : 1];
    return counts.map((count) => count / (copy.width * copy.height));
  });
}

// The outline of the elastic blend is the one in the player's picture, seen from z as there by a camera of the same lens.
// (Lights and colours differ.) The camera goes to where the boxes around both outlines are the same.
async function checkOutline(tab, picture) {
  await tab.click("#linear");
  await settled(tab);
  const [different, either] = await tab.evaluate(async (source, [width, height], fov) => {
    const { camera, canvas, elastic } = window.view, pixelSize = 2 * Math.tan(fov * Math.PI / 360) / height;
    const pixelsOf = (image) => {
      const context = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
      context.drawImage(image, 0, 0, width, height);
      return context.getImageData(0, 0, width, height).data;
    };
    const outlineOf = (pixels, isInside) => Array.from({ length: width * height }, (_, i) => isInside(pixels, 4 * i));
    const boxOf = (outline) => {
      const box = { left: width, right: 0, top: height, bottom: 0 };
      outline.forEach((isInside, i) => {
        if (!isInside) return;
        const x = i % width, y = Math.floor(i / width);
        Object.assign(box, { left: Math.min(box.left, x), right: Math.max(box.right, x), top: Math.min(box.top, y),
                             bottom: Math.max(box.bottom, y) });
      });
      return { size: box.right - box.left, x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 };
    };
    const draw = (target, distance) => {
      canvas.style.cssText = `position: fixed; width: ${width}px; height: ${height}px`;
      camera.fov = fov;
      camera.position.set(target.x, target.y, target.z + distance);
      camera.lookAt(target);
      window.view.draw();
      const outline = outlineOf(pixelsOf(canvas), (pixels, i) => pixels[i + 3] > 127);
      canvas.style.cssText = "";
      return outline;
    };
    const image = Object.assign(new Image(), { src: source });
    await image.decode(); // a warm skin before a cold studio
    const theirs = outlineOf(pixelsOf(image), (pixels, i) => pixels[i] > pixels[i + 2] + 16), wanted = boxOf(theirs);
    const target = elastic.geometry.boundingSphere.center.clone();
    let distance = 8 * elastic.geometry.boundingSphere.radius, ours = draw(target, distance);
    for (let i = 0; i < 6; ++i) {
      const seen = boxOf(ours);
      target.x += (seen.x - wanted.x) * pixelSize * distance;
      target.y -= (seen.y - wanted.y) * pixelSize * distance;
      distance *= seen.size / wanted.size;
      ours = draw(target, distance);
    }
    return [ours.filter((isInside, i) => isInside !== theirs[i]).length,
            ours.filter((isInside, i) => isInside || theirs[i]).length];
  }, `data:image/png;base64,${readFileSync(picture, "base64")}`, [640, 480], 26);
  console.log(`${different} of ${either} pixels of the outline differ from the player's`);
  assert.ok(either > 10000 && different < 0.01 * either, "the page draws another outline than the player");
  await tab.click("#linear");
  await settled(tab);
}

// A page that nobody touches draws nothing.
async function checkIdle(tab) {
  const drawn = () => tab.evaluate(async () => {
    for (let i = 0; i < 5; ++i) await new Promise(requestAnimationFrame);
    return window.view.renderer.info.render.frame;
  });
  assert.equal(await drawn(), await drawn(), "an idle page draws");
}

// As after sleep or a fault of the driver.
async function checkLostContext(tab) {
  await tab.evaluate(async () => {
    const { canvas, renderer } = window.view, lost = renderer.getContext().getExtension("WEBGL_lose_context");
    const next = (name) => new Promise((done) => { canvas.addEventListener(name, done, { once: true }); });
    const isLost = next("webglcontextlost");
    lost.loseContext();
    await isLost;
    await new Promise(requestAnimationFrame); // Chromium restores nothing in the event itself
    const isRestored = next("webglcontextrestored");
    lost.restoreContext();
    await isRestored;
    if (!window.view.needsDraw) throw new Error("the page stays empty after a lost graphics context");
  });
  const [left, right] = await drawnPixels(tab);
  assert.ok(left > 0.001 && right > 0.001, `after a lost graphics context ${left} and ${right} of the halves are drawn`);
}

async function checkLayers(tab, port) {
  await open(tab, port, `#file=layers.pliant&w=${expected.layers.weights}`);
  await checkPositions(tab, "layers");
  assert.match(await textOf(tab, "about"), /layers\.pliant: a rest shape and \d+ layers/);
  assert.equal(await tab.$eval("#polygon", (svg) => getComputedStyle(svg).display), "none");
}

// Links from anybody: weights that are none are left out, another file of the page is opened, others are not.
async function checkLinks(tab) {
  const go = (hash) => tab.evaluate((to) => new Promise((done) => { // the page has listened before this
    window.addEventListener("hashchange", done, { once: true });
    location.hash = to;
  }), hash);
  for (const weights of ["0,0,0", "-1,2,0", "1e39,0,0", "NaN,1,1", "1"]) {
    await go(`#file=averages.pliant&w=${weights}`);
    await settled(tab);
    assert.equal(await textOf(tab, "error"), "", weights);
  }
  await go("#file=../etc/passwd");
  await tab.waitForFunction(() => !document.getElementById("error").hidden, { timeout: 20000 });
  await go("#file=layers.pliant");
  await tab.waitForFunction(() => window.page.name === "layers.pliant", { timeout: 20000 });
  await go("#file=averages.pliant");
  await tab.waitForFunction(() => window.page.name === "averages.pliant" && !window.page.needsBlend, { timeout: 20000 });
}

// Whatever a fault might let into the page, only scripts of its own run, and it asks no other server.
async function checkPolicy(tab, port) {
  await open(tab, port, "#file=averages.pliant");
  const [hasRun, hasAsked] = await tab.evaluate(async (other) => {
    const script = Object.assign(document.createElement("script"), { textContent: "window.foreign = true" });
    document.body.append(script);
    return [window.foreign === true, await fetch(other, { mode: "no-cors" }).then(() => true, () => false)];
  }, `http://localhost:${port}/style.css`);
  assert.ok(!hasRun, "a script runs that is not of the page");
  assert.ok(!hasAsked, "the page asks another server");
}

async function checkKeyboard(tab) {
  const before = await tab.evaluate(() => window.page.weights.slice());
  await tab.focus("#sliders input");
  await tab.keyboard.press("ArrowRight");
  await settled(tab);
  const after = await tab.evaluate(() => window.page.weights.slice());
  assert.ok(after[0] > before[0], "the arrow key moved no weight");
  assert.ok(Math.abs(after.reduce((a, b) => a + b) - 1) < 1e-6, "weights of an average have the sum 1");
  assert.ok((await tab.evaluate(() => location.hash)).includes(`w=${Number(after[0].toFixed(4))},`), "the address is old");
  assert.ok(await tab.$$eval("input, button", (all) => all.every((element) =>
    element.labels?.length > 0 || element.textContent.trim())), "a control has no name");
}

// To a corner: that pose alone.
async function checkPolygon(tab) {
  const at = await tab.evaluate(() => {
    const svg = document.getElementById("polygon"), [x, y] = [0, -90];
    svg.scrollIntoView();
    const point = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
    return [point.x, point.y];
  });
  await tab.mouse.move(at[0], at[1] + 20);
  await tab.mouse.down();
  await tab.mouse.move(...at, { steps: 4 });
  await tab.mouse.up();
  await settled(tab);
  const weights = await tab.evaluate(() => window.page.weights);
  assert.ok(weights[0] > 0.97, `dragged to the first corner, the weights are ${weights}`);
}

async function checkFiles(tab) {
  const input = await tab.$("#file");
  await input.uploadFile(bad);
  await tab.waitForFunction(() => !document.getElementById("error").hidden, { timeout: 20000 });
  assert.match(await textOf(tab, "error"), /: /);
  const before = await tab.evaluate(() => window.page.name);
  assert.ok(before.endsWith(".pliant"), "the asset before the bad file is gone");
  await input.uploadFile(join(folder, "layers.pliant"));
  await tab.waitForFunction(() => window.page.name === "layers.pliant" && !window.page.needsBlend, { timeout: 20000 });
  assert.equal(await textOf(tab, "error"), "");
  await input.uploadFile(join(folder, "embedded.glb"));
  await tab.waitForFunction(() => window.page.name === "embedded.glb" && !window.page.needsBlend, { timeout: 20000 });
}

// The example of three.js draws frame after frame.
async function checkExample(tab, port) {
  await tab.goto(`http://127.0.0.1:${port}/example.html?file=averages.pliant`);
  await tab.waitForFunction(() => window.example?.renderer.info.render.frame > 3, { timeout: 30000 });
  assert.ok(await tab.evaluate(() => window.example.renderer.info.render.triangles) > 0, "the example draws nothing");
}

// Ten thousand blends need no more memory than ten.
async function checkMemory(tab) {
  const sizes = await tab.evaluate((count) => {
    const { view, page } = window, size = () => view.elastic.asset.parts.module.exports.memory.buffer.byteLength;
    const run = (frames) => {
      for (let i = 0; i < frames; ++i) view.elastic.setWeights(page.weights.map((weight, k) => Math.sin(i + k) ** 2 + 0.1));
    };
    run(10);
    const first = size();
    run(count);
    return [first, size()];
  }, 10000);
  assert.equal(sizes[0], sizes[1], "memory grows with the frames");
}

// Medians of the processor's part, and of whole frames with the drawing.
async function measure(tab) {
  return tab.evaluate(async () => {
    const { view, page } = window, blends = [], frames = [];
    for (let i = 0, last = 0; i < 60; ++i) {
      const weights = page.weights.map((_, k) => 0.5 + 0.4 * Math.sin(0.05 * i + k)), start = performance.now();
      for (let j = 0; j < 5; ++j) view.elastic.setWeights(weights.map((weight) => weight + 0.001 * j));
      blends.push((performance.now() - start) / 5); // a clock of whole milliseconds in Firefox
      const now = await new Promise(requestAnimationFrame);
      if (last > 0) frames.push(now - last);
      last = now;
    }
    const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
    return { blend: median(blends), frame: median(frames) };
  });
}

const { server, asked, port } = await serve(folder), browser = await launch(browserPath);
try {
  const tab = await browser.newPage(), problems = [];
  tab.on("pageerror", (error) => problems.push(error.message));
  await tab.setViewport({ width: 1100, height: 900 });
  await checkLayers(tab, port);
  await open(tab, port, `#file=averages.pliant&w=${expected.averages.weights}`);
  await checkPositions(tab, "averages");
  const [left, right] = await drawnPixels(tab);
  assert.ok(left > 0.01 && right > 0.01, `almost nothing is drawn: ${left}, ${right}`);
  await checkIdle(tab);
  await checkLostContext(tab);
  if (expected.player) await checkOutline(tab, expected.player);
  await tab.click("#linear");
  await settled(tab);
  assert.ok((await tab.evaluate(() => location.hash)).includes("linear=0"), "the switch is not in the address");
  await tab.click("#linear");
  await tab.click("#heat");
  await settled(tab);
  assert.ok(Number(await tab.$eval("#largest", (output) => output.value)) > 0, "no distance between both blends");
  await tab.screenshot({ path: picture });
  await checkLinks(tab);
  await checkKeyboard(tab);
  await checkPolygon(tab);
  const { blend, frame } = await measure(tab);
  console.log(`${await textOf(tab, "about")}: ${blend.toFixed(2)} ms for blend, positions and normals, `
    + `${frame.toFixed(0)} ms a frame with what draws it here (medians)`);
  await checkMemory(tab);
  await checkFiles(tab);
  await checkExample(tab, port);
  assert.deepEqual(problems, []);
  await checkPolicy(tab, port); // a refusal is a problem in Firefox
  const foreign = asked.filter((path) => !/^\/([\w-]+\.(html|js|css|pliant)|pliant\/[\w.]+|three\/[\w.]+)$/.test(path));
  assert.deepEqual(foreign, [], "the page asked for other files than its own");
} finally {
  await browser.close();
  server.close();
}
