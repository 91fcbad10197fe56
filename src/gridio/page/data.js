// SPDX-License-Identifier: BSD-3-Clause
// What the page holds: JSON, and blocks of bytes, packed, as base64.

const about = JSON.parse(document.getElementById("about").textContent);

async function block(id) {
  const element = document.getElementById(id);
  if (!element) return new Uint8Array(0);
  const text = atob(element.textContent);
  element.remove();
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const floats = (bytes) => new Float32Array(bytes.buffer, 0, bytes.length >> 2);
const integers = (bytes) => new Uint32Array(bytes.buffer, 0, bytes.length >> 2);

/** Rows of bits, each of whole bytes, as a byte for each voxel. */
function unpackBits(bytes, [nx, ny, nz]) {
  const out = new Uint8Array(nx * ny * nz), stride = (nx + 7) >> 3;
  for (let row = 0, at = 0; row < ny * nz; row++, at += nx)
    for (let b = 0; b < stride; b++) {
      const bits = bytes[row * stride + b];
      if (bits) for (let n = 0; n < 8; n++) if (bits >> n & 1) out[at + 8 * b + n] = 1;
    }
  return out;
}

/** High bytes, and behind them the low ones. */
function joinBytes(bytes) {
  const n = bytes.length >> 1, out = new Uint16Array(n);
  for (let i = 0; i < n; i++) out[i] = bytes[i] << 8 | bytes[n + i];
  return out;
}

// Numbers are whole ones: 0 is not a number, 1 to 32767 are below 0, 32768 to 65534 from 0 on.
const codeSteps = 32766, codeZero = 32768;
const codeOf = (value) => {
  const steps = Math.round(Math.min(Math.abs(value) / (about.scale || 1), 1) * codeSteps);
  return value < 0 ? codeZero - 1 - steps : codeZero + steps;
};

/** The voxels of the page: `codes` holds one number for each, or four of a colour. */
class Voxels {
  static async read() {
    const v = new Voxels();
    v.dims = about.dims;
    v.kind = about.kind;
    v.isColor = v.kind === "colors";
    v.isPalette = v.kind === "bits" || v.kind === "labels";
    v.isNumber = !v.isColor && !v.isPalette;
    const bytes = await block("voxels");
    v.codes = v.kind === "bits" ? unpackBits(bytes, v.dims) : v.isNumber ? joinBytes(bytes) : bytes;
    v.palette = new Uint8Array(256 * 4);
    if (v.kind === "bits") v.palette.set([222, 134, 78, 255], 4);
    for (const line of about.labels ?? [])
      v.palette.set([1, 3, 5].map((at) => parseInt(line.color.slice(at, at + 2), 16)).concat(255), 4 * line.code);
    v.low = 1; // numbers between these are drawn
    v.high = 65534;
    if (v.isNumber) v.setBounds(about.from, about.below);
    return v;
  }

  setBounds(from, below) {
    this.from = from;
    this.below = below;
    this.low = from === null ? 1 : codeOf(from);
    this.high = below === null ? 65534 : codeOf(below) - 1;
  }

  /** 1 for each code that is drawn. */
  table() {
    const table = new Uint8Array(this.isNumber ? 65536 : 256);
    if (this.isNumber) table.fill(1, this.low, Math.max(this.low, this.high + 1));
    else for (let code = 1; code < 256; code++) table[code] = this.isColor || this.palette[4 * code + 3] > 0 ? 1 : 0;
    return table;
  }

  /**
   * For each block of 8 voxels a side in how many levels, each twice as coarse, it is empty; and counts what is drawn,
   * and where it lies. */
  gaps() {
    const [nx, ny, nz] = this.dims, table = this.table(), codes = this.codes;
    const step = this.isColor ? 4 : 1, first = this.isColor ? 3 : 0;
    const size = this.dims.map((n) => (n + 7) >> 3), out = new Uint8Array(size[0] * size[1] * size[2]);
    const low = [...this.dims], high = [-1, -1, -1];
    let count = 0;
    for (let z = 0, at = first; z < nz; z++)
      for (let y = 0; y < ny; y++) {
        const row = ((z >> 3) * size[1] + (y >> 3)) * size[0];
        for (let x = 0; x < nx; x++, at += step)
          if (table[codes[at]]) {
            out[row + (x >> 3)] = 1;
            count++;
            if (x < low[0]) low[0] = x;
            if (x > high[0]) high[0] = x;
            if (y < low[1]) low[1] = y;
            if (y > high[1]) high[1] = y;
            if (z < low[2]) low[2] = z;
            high[2] = z;
          }
      }
    this.count = count;
    this.box = count > 0 ? { low, high: high.map((n) => n + 1) } : { low: [0, 0, 0], high: this.dims };
    const levels = [{ size, full: out.slice() }];
    while (levels.at(-1).size.some((n) => n > 1)) levels.push(coarser(levels.at(-1)));
    for (let z = 0, at = 0; z < size[2]; z++)
      for (let y = 0; y < size[1]; y++)
        for (let x = 0; x < size[0]; x++, at++) {
          let n = 0;
          while (n < levels.length && !levels[n].full[((z >> n) * levels[n].size[1] + (y >> n)) * levels[n].size[0] + (x >> n)]) n++;
          out[at] = n;
        }
    return { size, out };
  }
}

function coarser({ size, full }) {
  const half = size.map((n) => (n + 1) >> 1), out = new Uint8Array(half[0] * half[1] * half[2]);
  for (let z = 0, at = 0; z < size[2]; z++)
    for (let y = 0; y < size[1]; y++)
      for (let x = 0; x < size[0]; x++, at++) if (full[at]) out[((z >> 1) * half[1] + (y >> 1)) * half[0] + (x >> 1)] = 1;
  return { size: half, full: out };
}
