// SPDX-License-Identifier: BSD-3-Clause
// The panel: what is shown, and what can be switched. All text goes in as text, never as HTML.

function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

const short = (x) => x === null ? "" : Number(x.toPrecision(6)).toString();
const whole = (n) => n.toLocaleString("en").replaceAll(",", "\u202f");

function section(heading, ...children) {
  const s = make("section", {}, ...(heading ? [make("h2", { textContent: heading })] : []), ...children);
  document.getElementById("controls").append(s);
  return s;
}

function swatch(color) {
  const s = make("span", { className: "swatch" });
  s.style.background = color;
  return s;
}

function facts(voxels) {
  const box = make("div", { className: "facts" }), count = make("div"), size = about.voxel;
  box.append(make("div", { textContent: `${about.dims.join(" × ")} ${about.kind === "bits" ? "voxels" : about.kind}` }), count);
  box.append(make("div", { textContent: `voxel ${size.every((s) => s === size[0]) ? short(size[0]) : size.map(short).join(" × ")}` }));
  if (about.mesh) box.append(make("div", { textContent: `mesh: ${whole(about.mesh.vertices)} vertices, ${whole(about.mesh.faces)} faces` }));
  section("", box);
  return () => { count.textContent = `${whole(voxels.count)} ${voxels.isNumber ? "shown" : "set"}`; };
}

/** A slider along each axis: what lies beyond is cut away; turned, what lies before. */
function slices(state, changed) {
  const rows = [0, 1, 2].map((axis) => {
    const n = about.dims[axis], name = "xyz"[axis];
    const slider = make("input", { type: "range", min: 0, max: n, value: n, step: 1, ariaLabel: `cut along ${name}` });
    const text = make("span", { className: "number" });
    const turn = make("button", { textContent: "⇄", title: "cut away the other side", ariaPressed: "false" });
    slider.id = `slice-${name}`;
    const update = () => {
      const at = Math.max(state.turned[axis] ? 0 : 1, Math.min(+slider.value, state.turned[axis] ? n - 1 : n));
      state.low[axis] = state.turned[axis] ? at : 0;
      state.high[axis] = state.turned[axis] ? n : at;
      const isWhole = state.low[axis] === 0 && state.high[axis] === n;
      text.textContent = isWhole ? "all" : state.turned[axis] ? `${at} – ${n - 1}` : `0 – ${at - 1}`;
      slider.title = `${name} = ${short(about.origin[axis] + at * about.voxel[axis])}`;
    };
    slider.addEventListener("input", () => { update(); changed(); });
    turn.addEventListener("click", () => {
      state.turned[axis] = !state.turned[axis];
      turn.ariaPressed = String(state.turned[axis]);
      if (state.turned[axis] && +slider.value === n) slider.value = 0;
      else if (!state.turned[axis] && +slider.value === 0) slider.value = n;
      update();
      changed();
    });
    update();
    return make("div", { className: "row" }, make("span", { className: "axis", textContent: name }), slider, text, turn);
  });
  section("cut along", ...rows);
}

function checkbox(text, isOn, change) {
  const box = make("input", { type: "checkbox", checked: isOn });
  box.addEventListener("change", () => change(box.checked));
  return make("label", { className: "row" }, box, text);
}

/** From and below: the numbers that are drawn, and their colours. */
function threshold(voxels, state, changed, rebuilt) {
  const [low, high] = about.range, span = high - low || 1, rows = [];
  const bound = (name, key, other) => {
    const slider = make("input", { type: "range", min: low, max: high, step: span / 1000, value: voxels[key] ?? other, id: `bound-${key}`, ariaLabel: name });
    const text = make("span", { className: "number", textContent: short(voxels[key]) || "any" });
    slider.addEventListener("input", () => {
      const value = +slider.value, isAny = key === "from" ? value <= low : value >= high;
      voxels.setBounds(key === "from" ? (isAny ? null : value) : voxels.from, key === "below" ? (isAny ? null : value) : voxels.below);
      text.textContent = short(voxels[key]) || "any";
      rebuilt();
    });
    rows.push(make("div", { className: "row" }, make("span", { textContent: name }), slider, text));
  };
  bound("from", "from", low);
  bound("below", "below", high);
  rows.push(checkbox("values on the cuts", state.section, (on) => { state.section = on; changed(); }));
  const ramp = make("div", { className: "ramp" }), ends = make("div", { className: "ends" });
  const colors = ramps[voxels.kind] ?? ramps.numbers, stops = [];
  for (let i = 0; i < 256; i += 15) stops.push(`rgb(${colors[4 * i]} ${colors[4 * i + 1]} ${colors[4 * i + 2]})`);
  ramp.style.background = `linear-gradient(90deg, ${stops.join()})`;
  const names = voxels.kind === "distance" ? [short(-state.rampEnd), "0", (high > state.rampEnd ? "≥ " : "") + short(state.rampEnd)] : [short(low), short(high)];
  ends.append(...names.map((text) => make("span", { textContent: text })));
  section("shown: values", ...rows, ramp, ends);
}

/** Labels are switched by a click; with Alt or a second click alone. */
function legend(voxels, rebuilt) {
  const buttons = [], list = make("div", { className: "legend" });
  const set = (line, on) => {
    voxels.palette[4 * line.code + 3] = on ? 255 : 0;
    buttons[about.labels.indexOf(line)].ariaPressed = String(on);
  };
  const isOn = (line) => voxels.palette[4 * line.code + 3] > 0;
  for (const line of about.labels) {
    const button = make("button", { ariaPressed: "true", title: "click: on or off; double click: this one alone" },
      swatch(line.color), make("span", { className: "name", textContent: [line.label, line.name].filter(Boolean).join(" ") }),
      make("span", { className: "count", textContent: whole(line.count) }));
    button.addEventListener("click", () => { set(line, !isOn(line)); rebuilt(); });
    button.addEventListener("dblclick", () => { about.labels.forEach((other) => set(other, other === line)); rebuilt(); });
    buttons.push(button);
    list.append(button);
  }
  const all = (text, on) => {
    const button = make("button", { textContent: text });
    button.addEventListener("click", () => { about.labels.forEach((line) => set(line, on)); rebuilt(); });
    return button;
  };
  section("labels", make("div", { className: "row" }, all("all", true), all("none", false)), list);
}

function layers(overlay, state, changed) {
  const toggle = (text, key) => checkbox(text, state[key], (on) => { state[key] = on; changed(); });
  section("drawn", toggle("voxels", "voxels"), toggle("faces of the mesh", "meshFaces"), toggle("edges of the mesh", "meshEdges"));
  const lines = overlay.layers.map((layer) => {
    const row = checkbox("", layer.on, (on) => { layer.on = on; changed(); });
    row.title = layer.hint;
    row.append(swatch(layer.color), make("span", { className: "name", textContent: layer.name }), make("span", { className: "number", textContent: whole(layer.count) }));
    row.querySelector(".name").style.flex = "1";
    return row;
  });
  section("of the mesh", ...(lines.length ? lines : [make("div", { className: "facts", textContent: "no defects found, and none to repair" })]));
}

function foldable(changed) {
  const panel = document.getElementById("panel"), button = document.getElementById("fold");
  const fold = (on) => {
    panel.classList.toggle("folded", on);
    button.ariaExpanded = String(!on);
    changed();
  };
  button.addEventListener("click", () => fold(!panel.classList.contains("folded")));
  if (innerWidth <= 640 || innerHeight < 300) fold(true);
}
