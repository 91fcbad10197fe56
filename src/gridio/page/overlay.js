// SPDX-License-Identifier: BSD-3-Clause
// The mesh over the voxels, and layers of what is wrong with it.

const clipTest = `uniform vec3 clipLow, clipHigh;
in vec3 place;
void clip() { if (any(lessThan(place, clipLow)) || any(greaterThan(place, clipHigh))) discard; }`;

const faceVertex = `#version 300 es
layout(location = 0) in vec3 position;
uniform mat4 matrix;
uniform float size;
out vec3 place;
void main() {
  place = position;
  gl_Position = matrix * vec4(position, 1);
  gl_PointSize = size;
}`;

// A segment as two triangles, `size` pixels wide.
const segmentVertex = `#version 300 es
layout(location = 0) in vec3 begin;
layout(location = 1) in vec3 end;
uniform mat4 matrix;
uniform vec2 picture;
uniform float size;
out vec3 place;
void main() {
  vec4 a = matrix * vec4(begin, 1), b = matrix * vec4(end, 1);
  vec2 along = (b.xy / b.w - a.xy / a.w) * picture;
  vec2 aside = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(0, 1);
  bool atEnd = (gl_VertexID & 1) == 1;
  place = atEnd ? end : begin;
  gl_Position = atEnd ? b : a;
  gl_Position.xy += aside * ((gl_VertexID & 2) == 0 ? size : -size) / picture * gl_Position.w;
}`;

const plainFragment = `#version 300 es
precision highp float;
${clipTest}
uniform vec4 tint;
uniform vec3 light, top;
uniform bool lit;
out vec4 color;
void main() {
  clip();
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float shade = lit ? 0.6 + 0.15 * abs(dot(normal, top)) + 0.35 * abs(dot(normal, light)) : 1.0;
  color = vec4(tint.rgb * shade, tint.a);
}`;

const rgbOf = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);

class Overlay {
  static async read(gl) {
    const o = new Overlay();
    o.gl = gl;
    o.faces = compile(gl, faceVertex, plainFragment);
    o.segments = compile(gl, segmentVertex, plainFragment);
    const vertices = floats(await block("vertices")), triangles = integers(await block("triangles"));
    const flags = await block("flags");
    o.vertices = o.buffer(vertices);
    o.mesh = o.indexed(triangles);
    o.edges = o.indexed(edgesOf(triangles));
    o.layers = [];
    for (const layer of about.mesh.layers ?? []) o.layers.push({ ...layer, on: layer.what === "boundary_edge", rgb: rgbOf(layer.color), ...await o.read(layer, triangles, flags) });
    return o;
  }

  buffer(data, target = this.gl.ARRAY_BUFFER) {
    const buffer = this.gl.createBuffer();
    this.gl.bindVertexArray(null);
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, data, this.gl.STATIC_DRAW);
    return buffer;
  }

  /** Positions of a buffer, as attribute 0; with `pairs` two of them for an instance. */
  array(buffer, pairs, indices) {
    const gl = this.gl, array = gl.createVertexArray(), stride = pairs ? 24 : 12;
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (let n = 0; n < (pairs ? 2 : 1); n++) {
      gl.enableVertexAttribArray(n);
      gl.vertexAttribPointer(n, 3, gl.FLOAT, false, stride, 12 * n);
      gl.vertexAttribDivisor(n, pairs ? 1 : 0);
    }
    if (indices) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.bindVertexArray(null);
    return array;
  }

  indexed(indices) {
    return { array: this.array(this.vertices, false, this.buffer(indices, this.gl.ELEMENT_ARRAY_BUFFER)), elements: indices.length, isIndexed: true };
  }

  async read(layer, triangles, flags) {
    if (layer.what === "faces") return this.indexed(triangles.filter((_, n) => flags[n / 3 | 0] & layer.bit));
    const points = floats(await block(layer.what));
    const pairs = layer.bit === -2;
    return { array: this.array(this.buffer(points), pairs), elements: points.length / (pairs ? 6 : 3) };
  }

  begin(shader, scene) {
    const gl = this.gl, { program, place } = shader;
    gl.useProgram(program);
    gl.uniformMatrix4fv(place("matrix"), false, scene.matrix);
    gl.uniform2f(place("picture"), scene.width, scene.height);
    gl.uniform3fv(place("clipLow"), scene.clipLow);
    gl.uniform3fv(place("clipHigh"), scene.clipHigh);
    gl.uniform3fv(place("light"), scene.light);
    gl.uniform3fv(place("top"), scene.top);
  }

  /** @param part a thing with an array of vertices */
  put(part, mode, rgb, alpha, size, lit, scene) {
    const gl = this.gl, isSegment = part.bit === -2, { place } = isSegment ? this.segments : this.faces;
    this.begin(isSegment ? this.segments : this.faces, scene);
    gl.uniform4f(place("tint"), ...rgb, alpha);
    gl.uniform1f(place("size"), size * scene.ratio);
    gl.uniform1i(place("lit"), +lit);
    gl.bindVertexArray(part.array);
    if (isSegment) gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, part.elements);
    else if (part.isIndexed) gl.drawElements(mode, part.elements, gl.UNSIGNED_INT, 0);
    else gl.drawArrays(mode, 0, part.elements);
    gl.bindVertexArray(null);
  }

  putLayer(layer, alpha, scene) {
    const gl = this.gl, isPoint = layer.bit === -1;
    this.put(layer, isPoint ? gl.POINTS : gl.TRIANGLES, layer.rgb, alpha, isPoint ? 7 : 1.2, layer.bit >= 0, scene);
  }

  draw(state, scene) {
    const gl = this.gl;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    if (state.meshFaces) this.put(this.mesh, gl.TRIANGLES, [0.62, 0.68, 0.76], 1, 1, true, scene);
    gl.polygonOffset(-1, -2);
    const shown = this.layers.filter((layer) => layer.on);
    for (const layer of shown) if (layer.bit >= 0) this.putLayer(layer, 1, scene);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    if (state.meshEdges) this.put(this.edges, gl.LINES, [0.1, 0.14, 0.22], 0.45, 1, false, scene);
    gl.disable(gl.DEPTH_TEST); // what lies inside shines through
    for (const layer of shown) this.putLayer(layer, layer.bit >= 0 ? 0.18 : 0.45, scene);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    for (const layer of shown) if (layer.bit < 0) this.putLayer(layer, 1, scene);
    gl.disable(gl.BLEND);
  }
}

/** Each edge of the triangles once. */
function edgesOf(triangles) {
  const seen = new Set(), out = new Uint32Array(triangles.length * 2);
  let count = 0;
  for (let t = 0; t < triangles.length; t += 3)
    for (let n = 0; n < 3; n++) {
      const a = triangles[t + n], b = triangles[t + (n + 1) % 3];
      const key = a < b ? a * 4294967296 + b : b * 4294967296 + a;
      if (triangles.length < 600000) {
        if (seen.has(key)) continue;
        seen.add(key);
      }
      out[count++] = a;
      out[count++] = b;
    }
  return out.slice(0, count);
}
