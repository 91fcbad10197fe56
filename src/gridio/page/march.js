// SPDX-License-Identifier: BSD-3-Clause
// The voxels: a ray for each pixel goes through a texture of them, and leaves empty blocks at once.

const wholePicture = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); }`;

const marchSource = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler3D;
uniform usampler3D voxels, blocks;
uniform sampler2D palette, ramp;
uniform int kind;            // 0: codes of a palette, 1: numbers, 2: colours
uniform ivec3 dims, low, high; // what is cut away lies outside of low to high
uniform uvec2 bounds;        // of the numbers that are drawn
uniform bool section, diverging, ramped, quick;
uniform float codeScale, codeShift; // from a number of the code to a place in the ramp
uniform vec2 picture, reach, shift, planes; // planes: of the nearest and farthest depth
uniform vec3 eye, right, top, back, light, step3;
uniform float pixel;         // width of a pixel at distance 1
out vec4 color;

uint codeAt(ivec3 p) { return texelFetch(voxels, p, 0).r; }

bool isSet(ivec3 p) {
  if (any(lessThan(p, low)) || any(greaterThanEqual(p, high))) return false;
  uvec4 v = texelFetch(voxels, p, 0);
  if (kind == 0) return texelFetch(palette, ivec2(v.r, 0), 0).a > 0.5;
  return kind == 1 ? v.r >= bounds.x && v.r <= bounds.y : v.a > 0u;
}

vec3 rampAt(uint code) {
  float steps = code >= 32768u ? float(code - 32768u) : -float(32767u - code);
  float at = clamp(steps * codeScale + codeShift, 0.0, 1.0);
  return texelFetch(ramp, ivec2(at * 255.0 + 0.5, 0), 0).rgb;
}

vec3 colorAt(ivec3 p) {
  uvec4 v = texelFetch(voxels, p, 0);
  if (kind == 0) return texelFetch(palette, ivec2(v.r, 0), 0).rgb;
  if (kind == 2) return vec3(v.rgb) / 255.0;
  return ramped ? rampAt(v.r) : vec3(0.87, 0.525, 0.306);
}

// How the surface lies (toward which side it is empty), and how closed the place in front of a face is.
vec4 around(ivec3 p, ivec3 face) {
  vec3 sum = vec3(face) * 0.5;
  float closed = 0.0;
  for (int z = -1; z <= 1; z++)
    for (int y = -1; y <= 1; y++)
      for (int x = -1; x <= 1; x++) {
        ivec3 at = ivec3(x, y, z);
        if (at == ivec3(0) || !isSet(p + at)) continue;
        sum -= vec3(at) / dot(vec3(at), vec3(at));
        if (at.x * face.x + at.y * face.y + at.z * face.z > 0) closed += 0.125;
      }
  return vec4(normalize(sum / step3), closed);
}

// The value of each cell, with a line where its sign changes.
vec3 cut(ivec3 p, vec3 part, int axis) {
  uint code = codeAt(p);
  if (code == 0u) return vec3(0.8);
  vec3 c = rampAt(code);
  if (!diverging) return c;
  bool inside = code < 32768u;
  for (int n = 1; n <= 2; n++) {
    int a = (axis + n) % 3;
    for (int side = -1; side <= 1; side += 2) {
      ivec3 q = p;
      q[a] += side;
      float gap = side < 0 ? part[a] : 1.0 - part[a];
      if (gap > 0.14 || q[a] < 0 || q[a] >= dims[a]) continue;
      uint other = codeAt(q);
      if (other != 0u && other < 32768u != inside) return vec3(0.0);
    }
  }
  return c;
}

void main() {
  vec2 at = (gl_FragCoord.xy / picture * 2.0 - 1.0 - shift) * reach;
  vec3 ray = right * at.x + top * at.y - back, dir = ray / step3, origin = eye / step3;
  dir += vec3(equal(dir, vec3(0))) * 1e-9;
  vec3 inverse = 1.0 / dir;
  bvec3 forward = greaterThan(dir, vec3(0));
  vec3 enter = (mix(vec3(high), vec3(low), vec3(forward)) - origin) * inverse;
  vec3 leave = (mix(vec3(low), vec3(high), vec3(forward)) - origin) * inverse;
  float t = max(max(enter.x, enter.y), max(enter.z, 0.0)), end = min(leave.x, min(leave.y, leave.z));
  if (t >= end) discard;
  int axis = enter.x >= t ? 0 : enter.y >= t ? 1 : 2;
  ivec3 p = clamp(ivec3(floor(origin + t * dir)), low, high - 1);
  if (t > 0.0) p[axis] = forward[axis] ? low[axis] : high[axis] - 1;
  bool isCut = t > 0.0 && (forward[axis] ? low[axis] > 0 : high[axis] < dims[axis]);
  bool found = section && isCut;
  for (int n = 0; n < 4096 && !found; n++) {
    uint gap = texelFetch(blocks, p >> 3, 0).r;
    if (gap == 0u && isSet(p)) { found = true; break; }
    int bits = gap == 0u ? 0 : 2 + int(gap);
    ivec3 first = p >> bits << bits, last = first + (1 << bits);
    vec3 to = (mix(vec3(first), vec3(last), vec3(forward)) - origin) * inverse;
    axis = to.x < to.y ? (to.x < to.z ? 0 : 2) : (to.y < to.z ? 1 : 2);
    t = max(t, to[axis]);
    p = clamp(ivec3(floor(origin + t * dir)), first, last - 1);
    p[axis] = forward[axis] ? last[axis] : first[axis] - 1;
    isCut = false;
    if (any(lessThan(p, low)) || any(greaterThanEqual(p, high))) break;
  }
  if (!found) discard;

  ivec3 face = ivec3(0);
  face[axis] = forward[axis] ? -1 : 1;
  vec3 part = clamp(origin + t * dir - vec3(p), 0.0, 1.0);
  float pixels = max(step3.x, max(step3.y, step3.z)) / (pixel * max(t, 1e-6)); // of a voxel's side
  vec2 edge = abs(vec2(part[(axis + 1) % 3], part[(axis + 2) % 3]) - 0.5);
  float line = smoothstep(0.5 - 1.2 / pixels, 0.5 - 0.4 / pixels, max(edge.x, edge.y)) * smoothstep(5.0, 12.0, pixels);
  if (section && isCut) color = vec4(cut(p, part, axis) * (1.0 - 0.15 * line), 1);
  else {
    vec4 near = quick ? vec4(face, 0) : around(p, face);
    float smoothness = isCut ? 0.0 : 1.0 - smoothstep(3.0, 10.0, pixels);
    vec3 normal = normalize(mix(vec3(face), near.xyz, 0.9 * smoothness));
    float open = 1.0 - (0.45 - 0.3 * smoothness) * near.w, sun = max(dot(normal, light), 0.0);
    float sky = 0.62 + 0.16 * dot(normal, top);
    color = vec4(min(colorAt(p) * (sky * open + 0.5 * sun) * (1.0 - 0.28 * line), 1.0), 1);
  }
  gl_FragDepth = clamp(0.5 + 0.5 * (planes.y + planes.x - 2.0 * planes.y * planes.x / t) / (planes.y - planes.x), 0.0, 1.0);
}`;

function compile(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    const logs = gl.getAttachedShaders(program).map((shader) => gl.getShaderInfoLog(shader));
    throw new Error(`the graphics driver refuses a shader: ${gl.getProgramInfoLog(program)} ${logs.join(" ")}`);
  }
  const places = new Map();
  const place = (name) => places.has(name) ? places.get(name) : places.set(name, gl.getUniformLocation(program, name)).get(name);
  return { program, place };
}

/** Colours at equal steps, as 256 of them. */
function rampOf(stops) {
  const out = new Uint8Array(256 * 4).fill(255);
  for (let i = 0; i < 256; i++) {
    const at = i / 255 * (stops.length - 1), n = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; c++) out[4 * i + c] = Math.round(stops[n][c] + (at - n) * (stops[n + 1][c] - stops[n][c]));
  }
  return out;
}

const ramps = {
  distance: rampOf([[5, 48, 97], [33, 102, 172], [67, 147, 195], [146, 197, 222], [209, 229, 240], [247, 247, 247],
    [253, 219, 199], [244, 165, 130], [214, 96, 77], [178, 24, 43], [103, 0, 31]]),
  coverage: rampOf([[250, 250, 250], [20, 20, 20]]),
  numbers: rampOf([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]),
};
ramps.confidence = ramps.numbers;

class March {
  constructor(gl, voxels) {
    this.gl = gl;
    this.voxels = voxels;
    this.shader = compile(gl, wholePicture, marchSource);
    this.ramp = ramps[voxels.kind] ?? ramps.numbers;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const [format, layout, type] = voxels.isColor ? [gl.RGBA8UI, gl.RGBA_INTEGER, gl.UNSIGNED_BYTE]
      : voxels.isNumber ? [gl.R16UI, gl.RED_INTEGER, gl.UNSIGNED_SHORT] : [gl.R8UI, gl.RED_INTEGER, gl.UNSIGNED_BYTE];
    this.bind(0, gl.TEXTURE_3D);
    gl.texStorage3D(gl.TEXTURE_3D, 1, format, ...voxels.dims);
    gl.texSubImage3D(gl.TEXTURE_3D, 0, 0, 0, 0, ...voxels.dims, layout, type, voxels.codes);
    this.bind(1, gl.TEXTURE_3D);
    gl.texStorage3D(gl.TEXTURE_3D, 1, gl.R8UI, ...voxels.dims.map((n) => (n + 7) >> 3));
    this.bind(2, gl.TEXTURE_2D);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, 256, 1);
    this.bind(3, gl.TEXTURE_2D);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, 256, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.ramp);
    if (gl.getError() === gl.OUT_OF_MEMORY) throw new Error("the graphics card has no room for these voxels: make them at a lower resolution");
    this.update();
  }

  bind(unit, target) {
    const gl = this.gl, texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, texture);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(target, name, gl.NEAREST);
  }

  /** After another threshold, or labels that were switched. */
  update() {
    const gl = this.gl, { size, out } = this.voxels.gaps();
    gl.activeTexture(gl.TEXTURE1);
    gl.texSubImage3D(gl.TEXTURE_3D, 0, 0, 0, 0, ...size, gl.RED_INTEGER, gl.UNSIGNED_BYTE, out);
    gl.activeTexture(gl.TEXTURE2);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.voxels.palette);
  }

  draw(state, scene) {
    const gl = this.gl, v = this.voxels, { program, place } = this.shader;
    const ends = v.kind === "distance" ? [-state.rampEnd, state.rampEnd] : about.range ?? [0, 1];
    const span = ends[1] - ends[0] || 1;
    gl.useProgram(program);
    ["voxels", "blocks", "palette", "ramp"].forEach((name, unit) => gl.uniform1i(place(name), unit));
    gl.uniform1i(place("kind"), v.isColor ? 2 : v.isNumber ? 1 : 0);
    gl.uniform3iv(place("dims"), v.dims);
    gl.uniform3iv(place("low"), state.low);
    gl.uniform3iv(place("high"), state.high);
    gl.uniform2ui(place("bounds"), v.low, Math.max(v.high, 0));
    gl.uniform1i(place("section"), +(v.isNumber && state.section));
    gl.uniform1i(place("diverging"), +(v.kind === "distance"));
    gl.uniform1i(place("ramped"), +(v.kind === "confidence" || v.kind === "numbers"));
    gl.uniform1i(place("quick"), +scene.quick);
    gl.uniform1f(place("codeScale"), (about.scale || 1) / codeSteps / span);
    gl.uniform1f(place("codeShift"), -ends[0] / span);
    gl.uniform2f(place("picture"), scene.width, scene.height);
    gl.uniform2fv(place("reach"), scene.reach);
    gl.uniform2fv(place("shift"), scene.shift);
    gl.uniform2fv(place("planes"), scene.depths);
    for (const name of ["eye", "right", "top", "back", "light"]) gl.uniform3fv(place(name), scene[name]);
    gl.uniform3fv(place("step3"), scene.step);
    gl.uniform1f(place("pixel"), 2 * scene.reach[0] / scene.width);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
