/* SPDX-License-Identifier: BSD-3-Clause */
/* Flips the presence of a voxel, in a format in which the driver's XOR passed the self-test. */
#if defined IMAGE
layout(r32ui, binding = 0) coherent uniform uimage2DArray presence;
layout(location = 2) uniform int layer;
void flip() {
  imageAtomicXor(presence, ivec3(gl_FragCoord.xy, layer), 1u);
}
#elif defined NORMALIZED
layout(location = 0) out vec4 presence;
void flip() {
  presence = vec4(1.0);
}
#else
layout(location = 0) out uint presence;
void flip() {
  presence = 1u;
}
#endif

void main() {
#ifdef SECTION
  if (!is_inside())
    discard;
#endif
  flip();
}
