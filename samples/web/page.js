// The page: a file, its weights, two blends. The part of the address after '#' holds the weights and the switches.
import { load } from "pliant";
import { Polygon } from "./polygon.js";
import { View } from "./view.js";

const FIRST_FILE = "creature.pliant";
const $ = (id) => document.getElementById(id);

const polygon = new Polygon($("polygon"), (weights) => setWeights(weights));
const page = { asset: null, name: "", isServed: false, weights: [], needsBlend: false, turn: 0, timer: 0 };
let pliant, view;

// -- the address: #file=creature.pliant&w=0.5,0.5&heat=1&linear=0

function readAddress() {
  const fields = new URLSearchParams(location.hash.slice(1)), numbers = fields.get("w")?.split(",").map(Number);
  return { file: fields.get("file") ?? FIRST_FILE, weights: numbers ?? [], heat: fields.get("heat") === "1",
           linear: fields.get("linear") !== "0" };
}

function writeAddress() {
  clearTimeout(page.timer);
  page.timer = 0;
  const fields = new URLSearchParams();
  if (page.isServed) fields.set("file", page.name);
  fields.set("w", page.weights.map((weight) => Number(weight.toFixed(4))).join(","));
  if ($("heat").checked) fields.set("heat", "1");
  if (!$("linear").checked) fields.set("linear", "0");
  history.replaceState(null, "", `#${fields.toString().replaceAll("%2C", ",")}`);
}

// Browsers allow some hundred changes of the address in ten seconds; a drag makes more.
function writeAddressSoon() { page.timer ||= setTimeout(writeAddress, 200); }

// Of a link, from anybody.
function areWeights(weights) {
  const isNumber = (weight) => Math.abs(weight) <= 1e6, sum = weights.reduce((a, b) => a + b, 0);
  return weights.length === page.weights.length && weights.every(isNumber)
    && (page.asset.hasLayers || (weights.every((weight) => weight >= 0) && sum > 0));
}

// -- weights

function showWeights() {
  const inputs = $("sliders").querySelectorAll("input");
  page.weights.forEach((weight, k) => {
    inputs[k].value = weight;
    inputs[k].previousElementSibling.textContent = weight.toFixed(2);
  });
  if (!$("polygon").hasAttribute("hidden")) polygon.place(page.weights);
}

function setWeights(weights) {
  page.weights = Array.from(weights);
  page.needsBlend = true;
  showWeights();
  writeAddressSoon();
}

// A weight of an average is a share: the others make room for it in their proportions.
function setOne(k, value) {
  const weights = page.weights.slice(), others = weights.reduce((sum, weight, i) => sum + (i === k ? 0 : weight), 0);
  weights[k] = value;
  if (!page.asset.hasLayers) {
    const rest = 1 - value, count = weights.length - 1;
    for (let i = 0; i < weights.length; ++i)
      if (i !== k) weights[i] = others > 1e-6 ? weights[i] * rest / others : rest / count;
  }
  setWeights(weights);
}

function makeSliders() {
  const rows = page.asset.weights.map((weight, k) => {
    const label = document.createElement("label"), input = document.createElement("input"),
          name = document.createElement("span"), value = document.createElement("span");
    name.textContent = weight.name.slice(0, 200); // a file may have any: laying out a long one takes minutes
    value.ariaHidden = "true"; // the slider says it
    const step = Math.min(0.01, (weight.high - weight.low) / 100);
    Object.assign(input, { type: "range", min: weight.low, max: weight.high, step });
    input.addEventListener("input", () => setOne(k, Number(input.value)));
    label.append(name, value, input);
    return label;
  });
  $("sliders").replaceChildren(...rows);
}

// -- files

function fail(text) {
  $("error").textContent = text;
  $("error").hidden = text === "";
}

function openBytes(bytes, name, isServed) {
  let asset;
  try {
    asset = pliant.open(bytes);
    view.show(asset);
  } catch (error) {
    asset?.dispose();
    fail(`${name}: ${error.message}`);
    return false;
  }
  page.asset?.dispose();
  Object.assign(page, { asset, name, isServed });
  $("share").disabled = !isServed; // nobody else has the file
  fail("");
  const what = asset.hasLayers ? `a rest shape and ${asset.weights.length} layers` : `${asset.poseCount} poses`;
  $("about").textContent = `${name}: ${what}, ${asset.vertexCount.toLocaleString("en")} vertices, `
    + `${asset.dimension} unknowns`;
  makeSliders();
  polygon.show(asset);
  setWeights(asset.weights.map((weight) => weight.initial));
  return true;
}

// Of two files that are read at the same time the one that was asked for last counts.
function isLatest(turn) { return turn === page.turn; }

// A file beside the page, never of another place: the name may come from the address.
async function openServed(name) {
  const turn = ++page.turn, response = /^[\w.-]+$/.test(name) ? await fetch(`./${name}`).catch(() => null) : null;
  const bytes = response?.ok ? await response.arrayBuffer().catch(() => null) : null;
  if (!isLatest(turn)) return false;
  if (bytes) return openBytes(bytes, name, true);
  fail(`${name} cannot be fetched: open or drop a .pliant file`);
  return false;
}

async function openFile(file) {
  const turn = ++page.turn, bytes = await file.arrayBuffer().catch(() => null);
  if (!isLatest(turn)) return;
  if (bytes) openBytes(bytes, file.name, false);
  else fail(`${file.name} cannot be read`);
}

async function openAddress() {
  const wanted = readAddress();
  $("heat").checked = wanted.heat;
  $("linear").checked = wanted.linear;
  page.needsBlend = true;
  const isOpen = (page.isServed && page.name === wanted.file) || await openServed(wanted.file);
  if (isOpen && areWeights(wanted.weights)) setWeights(wanted.weights);
}

function listenToDrops() {
  const target = document.documentElement, show = (isOver) => { $("drop").hidden = !isOver; };
  target.addEventListener("dragover", (event) => { event.preventDefault(); show(true); });
  target.addEventListener("dragleave", (event) => { if (!event.relatedTarget) show(false); });
  target.addEventListener("drop", (event) => {
    event.preventDefault();
    show(false);
    if (event.dataTransfer.files.length > 0) openFile(event.dataTransfer.files[0]);
  });
}

// -- frames

function blend() {
  page.needsBlend = false;
  view.hasLinear = $("linear").checked;
  $("view").classList.toggle("single", !view.hasLinear);
  $("canvas").ariaLabel = `${page.name}: ${view.hasLinear ? "linear blend left, elastic blend right" : "elastic blend"}; `
    + "arrow keys move it";
  const { info, milliseconds, largest } = view.blend(page.weights, $("heat").checked);
  $("scale").hidden = !$("heat").checked;
  $("largest").value = (100 * largest).toFixed(1);
  $("cost").textContent = `${milliseconds.toFixed(2)} ms for blend, positions and normals; `
    + `${info.evaluations} evaluations, ${info.status}`
    + (info.outside > 0 ? `; outside of the proven range by ${info.outside.toFixed(2)}` : "");
}

function frame() {
  requestAnimationFrame(frame);
  if (!page.asset) return;
  try {
    if (page.needsBlend) blend();
    if (view.needsDraw) view.draw();
  } catch (error) {
    fail(error.message);
  }
}

async function share() {
  writeAddress();
  const isCopied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
  $("said").textContent = isCopied ? "Link copied" : "The link stands in the address bar";
}

function listen() {
  listenToDrops();
  $("file").addEventListener("change", () => {
    if ($("file").files.length > 0) openFile($("file").files[0]);
    $("file").value = ""; // the same file again is a change, too
  });
  $("panel").addEventListener("submit", (event) => event.preventDefault());
  $("reset").addEventListener("click",
    () => page.asset && setWeights(page.asset.weights.map((weight) => weight.initial)));
  $("share").addEventListener("click", share);
  for (const id of ["heat", "linear"])
    $(id).addEventListener("change", () => { page.needsBlend = true; writeAddressSoon(); });
  window.addEventListener("hashchange", openAddress);
}

async function start() {
  pliant = await load();
  view = window.view = new View($("canvas"));
  listen();
  requestAnimationFrame(frame);
  await openAddress();
}

// For tests and for curious people.
Object.assign(window, { page, setWeights });
start().catch((error) => fail(`The page cannot start: ${error.message}`));
