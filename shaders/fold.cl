/* SPDX-License-Identifier: BSD-3-Clause */
/* Prefix XOR: flips become the parity of all flips up to them, which is put or (`is_added`) ORed into `inside`; the
   flips are cleared. */

/* Along rows of words: rows, words of a row, words of it that hold voxels, valid bits of the last. */
__kernel void fold_rows(__global uint *flips, __global uint *inside, const uint4 shape, const uint is_added) {
  uint row = (uint)get_global_id(0), carry = 0;
  if (row >= shape.x)
    return;
  uint at = row * shape.y;
  for (uint w = 0; w < shape.y; w++, at++) {
    uint x = flips[at];
    if (x != 0) {
      flips[at] = 0;
      x ^= x << 1;
      x ^= x << 2;
      x ^= x << 4;
      x ^= x << 8;
      x ^= x << 16;
    }
    x ^= carry;
    carry = 0 - (x >> 31);
    if (w + 1 >= shape.z)
      x = w + 1 == shape.z ? x & shape.w : 0;
    if (!is_added)
      inside[at] = x;
    else if (x != 0)
      inside[at] |= x;
  }
}

/* From word to word, across rows or slices: lines, words side by side, from these to the next ones; words of a line,
   from one to the next. */
__kernel void fold_across(__global uint *flips, __global uint *inside, const uint4 shape, const uint2 line,
                          const uint is_added) {
  uint i = (uint)get_global_id(0), x = 0;
  if (i >= shape.x)
    return;
  uint at = i / shape.y * shape.z + i % shape.y;
  for (uint k = 0; k < line.x; k++, at += line.y) {
    uint flipped = flips[at];
    x ^= flipped;
    if (flipped != 0)
      flips[at] = 0;
    if (!is_added)
      inside[at] = x;
    else if (x != 0)
      inside[at] |= x;
  }
}

/* vxm_pass_box */
typedef struct Box {
  uint part, row_bits;
  uint first[3], last[3]; /* along bits, rows and slices of the whole space; the last ones are left out */
} Box;

/* Which parts set a voxel: those with a flip in their box, where each work-group looks. Boxes of one pass do not
   overlap. `slab`: first box, boxes; first slice, slice behind the last. */
__kernel void touch(__global const uint *flips, __global const Box *boxes, __global uint *touched, const uint4 slab,
                    const uint rows) {
  __local uint found;
  Box box = boxes[slab.x + (uint)get_group_id(0)];
  uint begin = max(box.first[2], slab.z), end = max(min(box.last[2], slab.w), begin);
  if (get_local_id(0) == 0)
    found = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  uint first = box.first[0] >> 5, words = (box.last[0] + 31) / 32 - first;
  uint high = box.last[1] - box.first[1], all_words = words * high * (end - begin);
  /* Until any of the group finds one: where flips lie, most work-items may have none on their way. */
  for (uint i = (uint)get_local_id(0); i < all_words && atomic_or(&found, 0u) == 0; i += GROUP) {
    uint row = i / words, w = first + i % words;
    uint slice = begin - slab.z + row / high, at = box.first[1] + row % high;
    uint bits = flips[(slice * rows + at) * (box.row_bits / 32) + w];
    if (w == first)
      bits &= ~0u << (box.first[0] & 31u);
    if (w == (box.last[0] - 1) >> 5 && (box.last[0] & 31u) != 0)
      bits &= (1u << (box.last[0] & 31u)) - 1;
    if (bits != 0)
      atomic_or(&found, 1u);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0 && found != 0)
    touched[box.part] = 1;
}
