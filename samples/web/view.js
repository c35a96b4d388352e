// Two meshes of one asset, the linear blend and the elastic one, under one camera.
import { BufferAttribute, Color, DirectionalLight, DoubleSide, HemisphereLight, MeshStandardMaterial, PerspectiveCamera, Scene,
         Sphere, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/OrbitControls.js";
import { PliantMesh } from "pliant/three";

const SKIN = new Color(0xd9cfc2), COLD = new Color(0x3d6fb8), MIDDLE = new Color(0xe8e4d8), HOT = new Color(0xc8392b);

// A sphere around the blends with one weight at its upper end, of the first 16 weights: the camera stands still while weights
// change.
function sphereOf(asset, mesh) {
  const whole = new Sphere();
  const single = asset.weights.map((weight, k) => asset.weights.map((_, i) => (i === k ? weight.high : 0)));
  for (const weights of single.slice(0, 16)) {
    mesh.setWeights(weights);
    if (whole.isEmpty()) whole.copy(mesh.geometry.boundingSphere);
    else whole.union(mesh.geometry.boundingSphere);
  }
  return whole;
}

function paint(mesh, distances, largest) {
  const { color } = mesh.geometry.attributes, shade = new Color();
  distances.forEach((distance, v) => {
    const share = largest > 0 ? distance / largest : 0;
    if (share < 0.5) shade.lerpColors(COLD, MIDDLE, 2 * share);
    else shade.lerpColors(MIDDLE, HOT, 2 * share - 1);
    color.setXYZ(v, shade.r, shade.g, shade.b);
  });
  color.needsUpdate = true;
}

export class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(30, 1, 0.01, 100);
    const light = new DirectionalLight(0xffffff, 2.2);
    light.position.set(-0.4, 0.8, 1);
    this.camera.add(light);
    this.scene.add(new HemisphereLight(0xffffff, 0x8a8378, 1.6), this.camera);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    const skin = { roughness: 0.75, side: DoubleSide }; // sheets and open mouths have an inside, too
    this.material = new MeshStandardMaterial({ ...skin, color: SKIN });
    this.heat = new MeshStandardMaterial({ ...skin, vertexColors: true });
    this.hasLinear = true;
    this.meshes = [];
    this.needsDraw = false; // a page that nobody touches costs nothing
    const redraw = () => { this.needsDraw = true; };
    this.controls.addEventListener("change", redraw);
    new ResizeObserver(redraw).observe(canvas);
    const start = () => { // a graphics context begins with the defaults, also after one was lost
      this.renderer.setScissorTest(true);
      redraw();
    };
    canvas.addEventListener("webglcontextrestored", start); // three.js has listened before this
    start();
  }

  show(asset) {
    const { meshes, sphere } = this.#meshesOf(asset); // the old ones stay if this fails
    for (const mesh of this.meshes) {
      this.scene.remove(mesh);
      mesh.dispose();
    }
    this.meshes = meshes;
    [this.linear, this.elastic] = meshes;
    this.scene.add(...meshes);
    this.#aim(sphere);
  }

  #meshesOf(asset) {
    const meshes = [];
    try {
      for (let i = 0; i < 2; ++i) {
        const mesh = new PliantMesh(asset, this.material), { count } = mesh.geometry.attributes.position;
        meshes.push(mesh);
        mesh.geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * count).fill(1), 3));
      }
      return { meshes, sphere: sphereOf(asset, meshes[1]) };
    } catch (error) {
      for (const mesh of meshes) mesh.dispose();
      throw error;
    }
  }

  #aim({ center, radius }) {
    this.diagonal = 2 * radius;
    this.controls.target.copy(center);
    this.camera.position.copy(center);
    this.camera.position.z += this.#distance(radius);
    this.camera.near = radius / 50;
    this.camera.far = 50 * radius;
    this.controls.update();
    this.controls.saveState();
  }

  // Where a sphere fills its part of the canvas, whichever side is the shorter one.
  #distance(radius) {
    const parts = this.hasLinear ? 2 : 1, aspect = this.canvas.clientWidth / parts / this.canvas.clientHeight;
    const half = Math.tan(this.camera.fov * Math.PI / 360) * Math.min(1, aspect || 1);
    return 0.85 * radius / Math.sin(Math.atan(half)); // the corners of its box are empty
  }

  // Milliseconds of the elastic blend, and the largest distance of both over the diagonal.
  blend(weights, hasHeat) {
    const start = performance.now(), info = this.elastic.setWeights(weights), milliseconds = performance.now() - start;
    if (this.hasLinear || hasHeat) this.linear.setLinearWeights(weights);
    for (const mesh of this.meshes) mesh.material = hasHeat ? this.heat : this.material;
    let largest = 0;
    if (hasHeat) {
      const distances = this.#distances();
      largest = distances.reduce((a, b) => Math.max(a, b), 0);
      for (const mesh of this.meshes) paint(mesh, distances, largest);
    }
    this.needsDraw = true;
    return { info, milliseconds, largest: largest / this.diagonal };
  }

  #distances() {
    const a = this.linear.geometry.attributes.position.array, b = this.elastic.geometry.attributes.position.array;
    const out = new Float32Array(a.length / 3);
    for (let v = 0; v < out.length; ++v)
      out[v] = Math.hypot(a[3 * v] - b[3 * v], a[3 * v + 1] - b[3 * v + 1], a[3 * v + 2] - b[3 * v + 2]);
    return out;
  }

  draw() {
    this.needsDraw = false;
    const { clientWidth: width, clientHeight: height } = this.canvas, ratio = Math.min(devicePixelRatio, 2);
    if (this.canvas.width !== Math.floor(width * ratio) || this.canvas.height !== Math.floor(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    const shown = this.hasLinear ? this.meshes : [this.elastic], part = width / shown.length;
    this.camera.aspect = part / height;
    this.camera.updateProjectionMatrix();
    shown.forEach((mesh, i) => {
      for (const each of this.meshes) each.visible = each === mesh;
      this.renderer.setViewport(i * part, 0, part, height);
      this.renderer.setScissor(i * part, 0, part, height);
      this.renderer.render(this.scene, this.camera);
    });
  }
}
