// The control polygon: a point in a regular polygon with a corner for each pose. Its weights are the mean value coordinates
// of the point (Floater, Mean value coordinates, Computer Aided Geometric Design 20(1), 2003).

const RADIUS = 90;

export function cornersOf(count) {
  return Array.from({ length: count }, (_, k) => {
    const angle = -Math.PI / 2 + 2 * Math.PI * k / count;
    return [RADIUS * Math.cos(angle), RADIUS * Math.sin(angle)];
  });
}

export function pointOf(weights, corners) {
  const sum = weights.reduce((a, b) => a + b, 0) || 1;
  return [0, 1].map((axis) => corners.reduce((at, corner, k) => at + corner[axis] * weights[k] / sum, 0));
}

const minus = (a, b) => [a[0] - b[0], a[1] - b[1]], cross = (a, b) => a[0] * b[1] - a[1] * b[0],
      dot = (a, b) => a[0] * b[0] + a[1] * b[1];

// Into the polygon: along the line to the middle.
function inside(point, corners) {
  let share = 1;
  corners.forEach((a, k) => {
    const edge = minus(corners[(k + 1) % corners.length], a), out = cross(edge, point), all = cross(edge, a);
    if (out / all > 1) share = Math.min(share, all / out);
  });
  return [share * point[0], share * point[1]];
}

export function weightsOf(point, corners) {
  const p = inside(point, corners), rays = corners.map((corner) => minus(corner, p)), n = corners.length;
  const lengths = rays.map((ray) => Math.hypot(...ray)), weights = new Array(n).fill(0);
  const at = lengths.findIndex((length) => length < 1e-6);
  if (at >= 0) return weights.map((_, k) => (k === at ? 1 : 0));
  for (let k = 0; k < n; ++k) {
    const next = (k + 1) % n, area = cross(rays[k], rays[next]), cosine = dot(rays[k], rays[next]);
    const denominator = lengths[k] * lengths[next] + cosine;
    if (denominator < 1e-9 * lengths[k] * lengths[next]) { // on this edge: the rays are opposite
      weights.fill(0);
      weights[k] = lengths[next];
      weights[next] = lengths[k];
      break;
    }
    const tangent = area / denominator; // of half the angle between both rays
    weights[k] += tangent / lengths[k];
    weights[next] += tangent / lengths[next];
  }
  const sum = weights.reduce((a, b) => a + b, 0);
  return weights.map((weight) => Math.max(weight / sum, 0));
}

// Without what all names begin with, such as "creature_".
function shortNames(names) {
  let common = 0;
  while (names.every((name) => common < name.length - 1 && name[common] === names[0][common])) ++common;
  while (common > 0 && /[^\s_.-]/.test(names[0][common - 1])) --common; // whole words
  return names.map((name) => name.slice(common, common + 16));
}

export class Polygon {
  constructor(svg, onChange) {
    this.svg = svg;
    this.onChange = onChange;
    svg.addEventListener("pointerdown", (event) => { svg.setPointerCapture(event.pointerId); this.#drag(event); });
    svg.addEventListener("pointermove", (event) => { if (svg.hasPointerCapture(event.pointerId)) this.#drag(event); });
  }

  // Two poses have a slider, layers have one each; more than twelve corners cannot be told apart.
  show(asset) {
    const count = asset.poseCount;
    this.svg.toggleAttribute("hidden", asset.hasLayers || count < 3 || count > 12);
    this.corners = cornersOf(count);
    const points = this.corners.map((corner) => corner.join(",")).join(" ");
    const element = (name, attributes, text = "") => {
      const made = document.createElementNS("http://www.w3.org/2000/svg", name);
      for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
      made.textContent = text;
      return made;
    };
    const names = shortNames(this.corners.map((_, k) => asset.poseName(k)));
    const labels = this.corners.map(([x, y], k) => {
      const side = Math.abs(x) < 1 ? "middle" : x > 0 ? "end" : "start"; // beside a corner, inwards: names may be long
      return element("text", { x: Math.abs(x) < 1 ? 0 : Math.sign(x) * 118, y: 1.1 * y + (y > 0 ? 12 : -6), "text-anchor": side },
                     names[k]);
    });
    this.handle = element("circle", { r: 8 });
    this.svg.replaceChildren(element("polygon", { points }), ...labels, this.handle);
  }

  place(weights) {
    const [x, y] = pointOf(weights, this.corners);
    this.handle.setAttribute("cx", x);
    this.handle.setAttribute("cy", y);
  }

  #drag(event) {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    this.onChange(weightsOf([at.x, at.y], this.corners));
  }
}
