// node page_memory.mjs BROWSER PAGE BAD FRAMES LEAK: the memory of the page does not grow while it is used. FRAMES are
// simulated in headless Chromium as fast as it can: the page asks for a frame, gets it at once, and the mouse has moved a
// slider, the point in the polygon or the camera, or changed a switch before. Every 300 frames another file is opened. The
// scene is drawn in one frame of DRAW_EVERY, since software draws it slowly; all else happens in every frame. Memory is read
// after a garbage collection, each time the first file is open. LEAK: numbers to keep in every frame, to see the test fail.
import { readFileSync } from "node:fs";
import { basename, join } from "node:path";
import { launch, open, serve } from "./tab.mjs";

const [browserPath, folder, bad, frames, leak] = process.argv.slice(2), OF_A_FILE = 300, DRAW_EVERY = 60;
const FILES = [join(folder, "averages.pliant"), join(folder, "layers.pliant"), join(folder, "embedded.glb"), bad];
const LARGEST_HEAP = 2; // kilobytes for 1000 frames over the second half

// In the tab: frames come when they are called for.
function takeClock() {
  const waiting = [];
  window.requestAnimationFrame = (call) => waiting.push(call);
  window.step = () => waiting.splice(0).forEach((call) => call(performance.now()));
}

// In the tab: one file, and some hundred frames of use.
async function useFile(name, numbers, count, drawEvery, lost) {
  const { page, view } = window, $ = (id) => document.getElementById(id), list = new DataTransfer();
  const below = (limit) => Math.floor(Math.random() * limit);
  const before = page.turn;
  list.items.add(new File([new Uint8Array(numbers)], name));
  $("file").files = list.files;
  $("file").dispatchEvent(new Event("change"));
  while (page.turn === before || (page.name !== name && $("error").hidden)) await new Promise((done) => setTimeout(done, 1));
  const send = (target, kind, x, y, type = PointerEvent) =>
    target.dispatchEvent(new type(kind, { clientX: x, clientY: y, pointerId: 1, pointerType: "mouse", button: 0, buttons: 1,
                                          bubbles: true, cancelable: true, deltaY: below(3) - 1 }));
  const moveSlider = () => {
    const inputs = $("sliders").querySelectorAll("input"), input = inputs[below(inputs.length)];
    input.value = Number(input.min) + Math.random() * (input.max - input.min);
    input.dispatchEvent(new Event("input"));
  };
  const drag = (target) => {
    const box = target.getBoundingClientRect();
    if (box.width === 0) return; // hidden
    send(target, "pointerdown", box.x + Math.random() * box.width, box.y + Math.random() * box.height);
    for (let i = 0; i < 3; ++i)
      send(target, "pointermove", box.x + Math.random() * box.width, box.y + Math.random() * box.height);
    send(target, "pointerup", box.x, box.y);
  };
  const render = view.renderer.render, nothing = () => {};
  for (let frame = 0; frame < count; ++frame) {
    const what = below(20);
    if (what < 10) moveSlider();
    else if (what < 15) drag($("polygon"));
    else if (what < 17) drag($("canvas"));
    else if (what < 18) send($("canvas"), "wheel", 10, 10, WheelEvent);
    else if (what < 19) $(["heat", "linear"][below(2)]).click();
    else if (below(3) === 0) $("reset").click();
    view.renderer.render = frame % drawEvery === 0 ? render : nothing;
    window.step();
    if (lost > 0) (window.lost ??= []).push(new Float64Array(lost));
  }
  view.renderer.render = render;
}

function growth(readings, key) {
  const late = readings.slice(readings.length >> 1), mean = (values) => values.reduce((a, b) => a + b) / values.length;
  const x = mean(late.map(({ frame }) => frame)), y = mean(late.map((reading) => reading[key]));
  return 1000 * late.reduce((sum, r) => sum + (r.frame - x) * (r[key] - y), 0) / late.reduce((sum, r) => sum + (r.frame - x) ** 2, 0);
}

async function read(tab, session, frame) {
  for (let i = 0; i < 2; ++i) await session.send("HeapProfiler.collectGarbage");
  const { usedSize, backingStorageSize = 0 } = await session.send("Runtime.getHeapUsage"); // objects; arrays of numbers
  const counters = await session.send("Memory.getDOMCounters");
  const { wasm, objects } = await tab.evaluate(() => {
    const { view } = window, { geometries, textures } = view.renderer.info.memory;
    return { wasm: view.elastic.asset.parts.module.exports.memory.buffer.byteLength / 1024, objects: geometries + textures };
  });
  return { frame, heap: (usedSize + backingStorageSize) / 1024, nodes: counters.nodes, listeners: counters.jsEventListeners, wasm, objects };
}

const { server, port } = await serve(folder), browser = await launch(browserPath), readings = [], problems = [];
try {
  const tab = await browser.newPage(), session = await tab.createCDPSession();
  tab.on("pageerror", (error) => problems.push(error.message));
  await tab.setViewport({ width: 640, height: 480 });
  await open(tab, port, "#file=averages.pliant");
  await tab.evaluate(takeClock);
  await new Promise((done) => setTimeout(done, 200)); // the last frame by the browser's clock
  const files = FILES.map((path) => [basename(path), [...readFileSync(path)]]);
  for (let frame = 0, turn = 0; frame < Number(frames); frame += OF_A_FILE, ++turn) {
    await tab.evaluate(useFile, ...files[turn % files.length], OF_A_FILE, DRAW_EVERY, Number(leak));
    if (turn % files.length === 0) readings.push(await read(tab, session, frame + OF_A_FILE));
  }
} finally {
  await browser.close();
  server.close();
}
const first = readings[0], middle = readings[readings.length >> 1], last = readings.at(-1), grown = growth(readings, "heap");
for (const [when, reading] of Object.entries({ first, middle, last })) console.log(when, JSON.stringify(reading));
console.log(`${frames} frames, ${readings.length} readings; second half: ${grown.toFixed(2)} kB of JavaScript for 1000 frames `
  + `(at most ${LARGEST_HEAP})`);
const wrong = ["nodes", "listeners", "wasm", "objects"].filter((key) => last[key] > middle[key]);
if (problems.length > 0) console.log(problems.slice(0, 5));
if (wrong.length > 0) console.log(`grown: ${wrong}`);
process.exit(grown > LARGEST_HEAP || wrong.length > 0 || problems.length > 0 ? 1 : 0);
