// SPDX-License-Identifier: BSD-3-Clause
// Puts all together: reads the data, draws when something has changed, coarsely while it moves.

const message = document.getElementById("message"), canvas = document.getElementById("view");

class View {
  constructor(gl, voxels, overlay) {
    const longest = Math.max(...about.dims.map((n, a) => n * about.voxel[a]));
    this.gl = gl;
    this.voxels = voxels;
    this.overlay = overlay;
    this.step = about.voxel.map((size) => size / longest);
    this.state = { low: [0, 0, 0], high: [...about.dims], turned: [false, false, false], section: true, voxels: true, meshFaces: false,
      meshEdges: Boolean(overlay) && about.mesh.triangles <= 30000,
      rampEnd: about.range ? Math.max(-about.range[0], Math.abs(about.range[1]) / 2) || 1 : 1 }; // farther outside is as dark
    this.march = new March(gl, voxels);
    const [low, high] = [voxels.box.low, voxels.box.high].map((corner) => corner.map((n, a) => n * this.step[a]));
    this.camera = new Camera(low, high, about.up);
    this.scale = 1; // of pixels while it moves
    this.waiting = false;
  }

  /** Parts of the picture by which its middle is moved, as the panel covers some. */
  shift() {
    const panel = document.getElementById("panel").getBoundingClientRect();
    if (document.getElementById("panel").classList.contains("folded")) return [0, 0];
    if (innerWidth <= 640) return [0, panel.height / innerHeight];
    return [panel.right < innerWidth / 2 ? panel.right / innerWidth : 0, 0];
  }

  draw(scale) {
    const { gl, camera, state } = this, ratio = (devicePixelRatio || 1) * scale;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const axes = camera.axes(), shift = this.shift();
    const free = [width * (1 - Math.abs(shift[0])), height * (1 - Math.abs(shift[1]))], shorter = Math.min(...free);
    const reach = [camera.half * width / shorter, camera.half * height / shorter];
    const light = add(add(axes.right.map((x) => -0.45 * x), 0.95, axes.up), 0.5, axes.back), length = Math.hypot(...light);
    const scene = { ...axes, width, height, ratio, reach, shift, depths: camera.depths(), step: this.step, quick: scale < 0.7, light: light.map((x) => x / length),
      matrix: camera.matrix(reach, shift), clipLow: state.low.map((n, a) => n > 0 ? n * this.step[a] : -1e9),
      clipHigh: state.high.map((n, a) => n < about.dims[a] ? n * this.step[a] : 1e9) };
    gl.viewport(0, 0, width, height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    if (state.voxels) this.march.draw(state, scene);
    if (this.overlay) this.overlay.draw(state, scene);
  }

  /** Soon, and whole when nothing moves any more. */
  moved() {
    clearTimeout(this.rest);
    this.rest = setTimeout(() => requestAnimationFrame(() => this.draw(1)), 180);
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      const start = performance.now();
      this.draw(this.scale);
      this.pixel(0, 0); // waits until it is drawn
      const took = performance.now() - start;
      if (took > 40) this.scale = Math.max(0.2, this.scale * Math.max(0.5, Math.sqrt(30 / took)));
      else if (took < 15) this.scale = Math.min(1, this.scale * 1.15);
    });
  }

  /** A pixel just drawn, by its place from the lower left corner. */
  pixel(x, y) {
    const out = new Uint8Array(4);
    this.gl.readPixels(x, y, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, out);
    return [...out.slice(0, 3)];
  }

  /** Milliseconds for a frame, each from another side. */
  measure(frames, scale) {
    const start = performance.now();
    for (let n = 0; n < frames; n++) {
      this.camera.turn(360 / frames, 0);
      this.draw(scale);
      this.pixel(0, 0);
    }
    return (performance.now() - start) / frames;
  }
}

/** What a test, or who wonders, can ask the page: attributes of its root. */
function tell(view) {
  const root = document.documentElement.dataset;
  view.draw(1);
  const shift = view.shift();
  root.pixel = view.pixel(Math.floor(canvas.width * (1 + shift[0]) / 2), Math.floor(canvas.height * (1 + shift[1]) / 2)).join();
  root.voxels = view.voxels.count;
  root.ready = "yes";
}

async function start() {
  document.title = about.title ? `${about.title} – voxmend` : "voxmend";
  document.getElementById("title").textContent = about.title || "voxmend";
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  if (!gl) throw new Error("this browser has no WebGL 2, which draws the voxels: switch its graphics acceleration on, or use another one");
  const voxels = await Voxels.read();
  const overlay = about.mesh && !about.mesh.omitted ? await Overlay.read(gl) : null;
  const view = new View(gl, voxels, overlay);
  const changed = () => view.moved();
  const count = facts(voxels);
  const rebuilt = () => {
    view.march.update();
    count();
    changed();
  };
  count();
  slices(view.state, changed);
  if (voxels.isNumber) threshold(voxels, view.state, changed, rebuilt);
  if (voxels.kind === "labels") legend(voxels, rebuilt);
  if (overlay) layers(overlay, view.state, changed);
  document.getElementById("controls").append(make("p", { className: "hint",
    textContent: "drag: turn · shift or right button: move · wheel: zoom · double click or 0: whole · keys: arrows, + −, 1 2 3" }));
  foldable(changed);
  steer(canvas, view.camera, changed);
  new ResizeObserver(() => view.draw(1)).observe(canvas); // at once, or it would be seen stretched
  message.textContent = "";
  window.voxmendView = view;
  tell(view);
}

start().catch((error) => {
  message.textContent = `This cannot be shown: ${error.message}`;
  document.documentElement.dataset.ready = "failed";
  console.error(error);
});
