// SPDX-License-Identifier: BSD-3-Clause
// From where the voxels are seen, and how mouse, touch and keys change that. The longest side of the grid is 1.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, k, b) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

class Camera {
  /** @param low, high corners of what is to be seen */
  constructor(low, high, up) {
    this.middle = low.map((x, a) => (x + high[a]) / 2);
    this.radius = Math.hypot(...low.map((x, a) => high[a] - x)) / 2;
    this.up = up;
    this.half = 0.26; // tangent of half the angle of the shorter side
    this.reset();
  }

  reset() {
    this.azimuth = 30;
    this.elevation = 25;
    this.target = [...this.middle];
    this.distance = 0.97 * this.radius / Math.sin(Math.atan(this.half));
  }

  look(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = elevation;
  }

  /** Unit vectors and the eye; as the pictures of voxmend have them. */
  axes() {
    const radian = Math.PI / 180, a = this.azimuth * radian, e = this.elevation * radian;
    const axis = (n) => [0, 1, 2].map((m) => +(m === n % 3));
    const e1 = axis(this.up + 1), e2 = axis(this.up + 2), up = axis(this.up);
    const level = add(e1.map((x) => x * Math.cos(a)), Math.sin(a), e2);
    const back = add(level.map((x) => x * Math.cos(e)), Math.sin(e), up);
    const right = add(e1.map((x) => -x * Math.sin(a)), Math.cos(a), e2);
    const top = cross(back, right);
    return { back, right, top, up, level, eye: add(this.target, this.distance, back) };
  }

  depths() {
    return [this.distance * 0.02, this.distance + 4];
  }

  /**
   * From scene coordinates to clip space, by columns.
   * @param reach tangents of half the angles across and upward; @param shift moves the picture
   */
  matrix([tx, ty], shift) {
    const { back, right, top, eye } = this.axes(), [n, f] = this.depths();
    const along = (axis, k) => [...axis.map((x) => x * k), -dot(axis, eye) * k];
    const w = along(back, -1), depth = (f + n) / (f - n), offset = -2 * f * n / (f - n);
    const x = along(right, 1 / tx).map((v, i) => v + shift[0] * w[i]);
    const y = along(top, 1 / ty).map((v, i) => v + shift[1] * w[i]);
    const z = w.map((v, i) => v * depth + (i === 3 ? offset : 0));
    return new Float32Array([0, 1, 2, 3].flatMap((i) => [x[i], y[i], z[i], w[i]]));
  }

  turn(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + dy));
  }

  /** By parts of the picture's shorter half side. */
  pan(dx, dy) {
    const { right, top } = this.axes(), k = this.distance * this.half;
    this.target = add(add(this.target, -dx * k, right), dy * k, top);
  }

  zoom(factor) {
    this.distance = Math.max(0.02, Math.min(50, this.distance * factor));
  }
}

/** Calls `moved` after each change. */
function steer(canvas, camera, moved) {
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()], n = all.length;
    const x = all.reduce((s, p) => s + p.x, 0) / n, y = all.reduce((s, p) => s + p.y, 0) / n;
    return { x, y, spread: n > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0 };
  };
  const place = (event) => pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    place(event);
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return;
    const before = middle();
    place(event);
    const after = middle(), dx = after.x - before.x, dy = after.y - before.y;
    const half = Math.min(canvas.clientWidth, canvas.clientHeight) / 2;
    if (pointers.size > 1 || event.shiftKey || event.buttons & 6) camera.pan(dx / half, dy / half);
    else camera.turn(dx * 0.35, dy * 0.35);
    if (before.spread > 0 && after.spread > 0) camera.zoom(before.spread / after.spread);
    moved();
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(Math.max(-200, Math.min(200, event.deltaY * (event.deltaMode === 1 ? 30 : 1))) * 0.0012));
    moved();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => {
    camera.reset();
    moved();
  });
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  canvas.addEventListener("keydown", (event) => {
    const arrow = arrows[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (arrow && event.shiftKey) camera.pan(-0.1 * arrow[0], -0.1 * arrow[1]);
    else if (arrow) camera.turn(8 * arrow[0], -8 * arrow[1]);
    else if (event.key === "+" || event.key === "=") camera.zoom(0.85);
    else if (event.key === "-") camera.zoom(1 / 0.85);
    else if (event.key === "0" || event.key === "Home") camera.reset();
    else if (event.key === "1") camera.look(0, 0);
    else if (event.key === "2") camera.look(90, 0);
    else if (event.key === "3") camera.look(0, 90);
    else return;
    event.preventDefault();
    moved();
  });
}
