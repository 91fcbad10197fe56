/* SPDX-License-Identifier: BSD-3-Clause */
/* The centres of voxels are moved a little, as the lattice does it with numbers that are infinitely small
   (lattice.h): here by 2^-24, 2^-31 and 2^-38 voxel along x, y and z, which doubles still tell apart. */
double nudge(int axis) {
  return axis == 0 ? 5.9604644775390625e-8LF : axis == 1 ? 4.656612873077393e-10LF : 3.637978807091713e-12LF;
}
