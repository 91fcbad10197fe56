/* SPDX-License-Identifier: BSD-3-Clause */
/* Which parts set a voxel: those with a flip in their box, where each work group looks. Boxes of one pass do not
   overlap. */
layout(local_size_x = 64) in;
struct Box {
  uint part, row_bits; // number of the part; bits of a row
  uint first[3], last[3]; // along bits, rows and slices of the whole space; the last ones are left out
};
layout(std430, binding = 3) readonly buffer Flips {
  uint word[];
} flips;
layout(std430, binding = 4) readonly buffer Boxes {
  Box box[];
} boxes;
layout(std430, binding = 5) writeonly buffer Touched {
  uint touched[];
} parts;
layout(location = 0) uniform uvec4 slab; // first box, boxes; first slice, slice behind the last
layout(location = 1) uniform uint rows;  // of a slice

shared uint found;

void main() {
  uint b = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (b >= slab.y)
    return;
  Box box = boxes.box[slab.x + b];
  uint begin = max(box.first[2], slab.z), end = max(min(box.last[2], slab.w), begin);
  if (gl_LocalInvocationIndex == 0u)
    found = 0u;
  barrier();
  uint first = box.first[0] >> 5, words = (box.last[0] + 31u) / 32u - first;
  uint high = box.last[1] - box.first[1], deep = end - begin, all_words = words * high * deep;
  /* Until any of the group finds one: where flips lie, most invocations may have none on their way. */
  for (uint i = gl_LocalInvocationIndex; i < all_words && atomicOr(found, 0u) == 0u; i += 64u) {
    uint row = i / words, w = first + i % words;
    uint slice = begin - slab.z + row / high, at = box.first[1] + row % high;
    uint bits = flips.word[(slice * rows + at) * (box.row_bits / 32u) + w];
    if (w == first)
      bits &= ~0u << (box.first[0] & 31u);
    if (w == (box.last[0] - 1u) >> 5 && (box.last[0] & 31u) != 0u)
      bits &= (1u << (box.last[0] & 31u)) - 1u;
    if (bits != 0u)
      atomicOr(found, 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && found != 0u)
    parts.touched[box.part] = 1u;
}
