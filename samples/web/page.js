// The page: a file, its weights, two blends. State is the weights and the switches; it stands in the address behind '#'.
import { load } from "pliant";
import { Polygon } from "./polygon.js";
import { View } from "./view.js";

const FIRST_FILE = "creature.pliant";
const $ = (id) => document.getElementById(id);

const polygon = new Polygon($("polygon"), (weights) => setWeights(weights));
const page = { asset: null, name: "", weights: [], needsBlend: false };
let pliant, view;

// -- the address: #file=creature.pliant&w=0.5,0.5&heat=1&linear=0

function readAddress() {
  const fields = new URLSearchParams(location.hash.slice(1)), numbers = fields.get("w")?.split(",").map(Number);
  return { file: fields.get("file"), weights: numbers?.every(Number.isFinite) ? numbers : null,
           heat: fields.get("heat") === "1", linear: fields.get("linear") !== "0" };
}

function writeAddress() {
  const fields = new URLSearchParams();
  if (page.isServed) fields.set("file", page.name);
  fields.set("w", page.weights.map((weight) => Number(weight.toFixed(4))).join(","));
  if ($("heat").checked) fields.set("heat", "1");
  if (!$("linear").checked) fields.set("linear", "0");
  history.replaceState(null, "", `#${fields.toString().replaceAll("%2C", ",")}`);
}

// -- weights

function showWeights() {
  const inputs = $("sliders").querySelectorAll("input");
  page.weights.forEach((weight, k) => {
    inputs[k].value = weight;
    inputs[k].previousElementSibling.value = weight.toFixed(2);
  });
  if (!$("polygon").hasAttribute("hidden")) polygon.place(page.weights);
}

function setWeights(weights) {
  page.weights = Array.from(weights);
  page.needsBlend = true;
  showWeights();
  writeAddress();
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
    const label = document.createElement("label"), value = document.createElement("output"),
          input = document.createElement("input"), name = document.createElement("span");
    name.textContent = weight.name;
    Object.assign(input, { type: "range", min: weight.low, max: weight.high, step: 0.01 });
    input.setAttribute("aria-label", weight.name);
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
  fail("");
  const what = asset.hasLayers ? `a rest shape and ${asset.weights.length} layers` : `${asset.poseCount} poses`;
  $("about").textContent = `${name}: ${what}, ${asset.vertexCount.toLocaleString("en")} vertices, `
    + `${asset.dimension} unknowns`;
  makeSliders();
  polygon.show(asset);
  setWeights(asset.weights.map((weight) => weight.initial));
  return true;
}

// A file beside the page, never of another place: the name may come from the address.
async function openServed(name) {
  const response = /^[\w.-]+$/.test(name) ? await fetch(`./${name}`).catch(() => null) : null;
  if (response?.ok) return openBytes(await response.arrayBuffer(), name, true);
  fail(`${name} cannot be fetched: open or drop a .pliant file`);
  return false;
}

async function openFile(file) {
  try {
    openBytes(await file.arrayBuffer(), file.name, false);
  } catch {
    fail(`${file.name} cannot be read`);
  }
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

function frame() {
  requestAnimationFrame(frame);
  if (!page.asset) return;
  if (page.needsBlend) {
    page.needsBlend = false;
    view.hasLinear = $("linear").checked;
    $("view").classList.toggle("single", !view.hasLinear);
    const { info, milliseconds, largest } = view.blend(page.weights, $("heat").checked);
    $("scale").hidden = !$("heat").checked;
    $("largest").value = (100 * largest).toFixed(1);
    $("cost").textContent = `${milliseconds.toFixed(2)} ms for blend, positions and normals; `
      + `${info.evaluations} evaluations, ${info.status}`
      + (info.outside > 0 ? `; outside of the proven range by ${info.outside.toFixed(2)}` : "");
  }
  view.draw();
}

async function start() {
  pliant = await load();
  view = window.view = new View($("canvas"));
  const wanted = readAddress();
  $("heat").checked = wanted.heat;
  $("linear").checked = wanted.linear;
  listenToDrops();
  $("file").addEventListener("change", () => { if ($("file").files.length > 0) openFile($("file").files[0]); });
  $("panel").addEventListener("submit", (event) => event.preventDefault());
  $("reset").addEventListener("click", () => page.asset && setWeights(page.asset.weights.map((weight) => weight.initial)));
  $("share").addEventListener("click", () => navigator.clipboard.writeText(location.href).catch(() => {}));
  for (const id of ["heat", "linear"])
    $(id).addEventListener("change", () => { page.needsBlend = true; writeAddress(); });
  const isOpen = await openServed(wanted.file ?? FIRST_FILE);
  if (isOpen && wanted.weights?.length === page.weights.length) setWeights(wanted.weights);
  requestAnimationFrame(frame);
}

// For tests and for curious people.
Object.assign(window, { page, setWeights });
start().catch((error) => fail(`The page cannot start: ${error.message}`));
