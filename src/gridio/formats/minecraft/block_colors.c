/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/minecraft/block_colors.h"
#include "mesh/appearance.h"

#include <math.h>
#include <string.h>

/** Averages over the 16 x 16 pixels of the textures that the game has had since 1.14. Blocks that fall, melt,
 * glow, have another face on each side or let light through are left out. */
static const vxm_block_color blocks[] = {
    {"minecraft:white_concrete", {207, 213, 214}},
    {"minecraft:orange_concrete", {224, 97, 1}},
    {"minecraft:magenta_concrete", {169, 48, 159}},
    {"minecraft:light_blue_concrete", {36, 137, 199}},
    {"minecraft:yellow_concrete", {241, 175, 21}},
    {"minecraft:lime_concrete", {94, 169, 25}},
    {"minecraft:pink_concrete", {214, 101, 143}},
    {"minecraft:gray_concrete", {55, 58, 62}},
    {"minecraft:light_gray_concrete", {125, 125, 115}},
    {"minecraft:cyan_concrete", {21, 119, 136}},
    {"minecraft:purple_concrete", {100, 32, 156}},
    {"minecraft:blue_concrete", {45, 47, 143}},
    {"minecraft:brown_concrete", {96, 60, 32}},
    {"minecraft:green_concrete", {73, 91, 36}},
    {"minecraft:red_concrete", {142, 33, 33}},
    {"minecraft:black_concrete", {8, 10, 15}},
    {"minecraft:white_wool", {234, 236, 237}},
    {"minecraft:orange_wool", {241, 118, 20}},
    {"minecraft:magenta_wool", {190, 69, 180}},
    {"minecraft:light_blue_wool", {58, 175, 217}},
    {"minecraft:yellow_wool", {249, 198, 40}},
    {"minecraft:lime_wool", {112, 185, 26}},
    {"minecraft:pink_wool", {238, 141, 172}},
    {"minecraft:gray_wool", {63, 68, 72}},
    {"minecraft:light_gray_wool", {142, 142, 135}},
    {"minecraft:cyan_wool", {21, 138, 145}},
    {"minecraft:purple_wool", {122, 42, 173}},
    {"minecraft:blue_wool", {53, 57, 157}},
    {"minecraft:brown_wool", {114, 72, 41}},
    {"minecraft:green_wool", {85, 110, 28}},
    {"minecraft:red_wool", {161, 39, 35}},
    {"minecraft:black_wool", {21, 21, 26}},
    {"minecraft:white_terracotta", {210, 178, 161}},
    {"minecraft:orange_terracotta", {162, 84, 38}},
    {"minecraft:magenta_terracotta", {150, 88, 109}},
    {"minecraft:light_blue_terracotta", {114, 109, 138}},
    {"minecraft:yellow_terracotta", {186, 133, 35}},
    {"minecraft:lime_terracotta", {104, 118, 53}},
    {"minecraft:pink_terracotta", {162, 78, 79}},
    {"minecraft:gray_terracotta", {58, 42, 36}},
    {"minecraft:light_gray_terracotta", {135, 107, 98}},
    {"minecraft:cyan_terracotta", {87, 91, 91}},
    {"minecraft:purple_terracotta", {118, 70, 86}},
    {"minecraft:blue_terracotta", {74, 60, 91}},
    {"minecraft:brown_terracotta", {77, 51, 36}},
    {"minecraft:green_terracotta", {76, 83, 42}},
    {"minecraft:red_terracotta", {143, 61, 47}},
    {"minecraft:black_terracotta", {37, 23, 16}},
    {"minecraft:terracotta", {152, 94, 68}},
    {"minecraft:stone", {126, 126, 126}},
    {"minecraft:smooth_stone", {159, 159, 159}},
    {"minecraft:granite", {149, 103, 86}},
    {"minecraft:diorite", {189, 188, 189}},
    {"minecraft:andesite", {136, 136, 137}},
    {"minecraft:cobblestone", {128, 127, 128}},
    {"minecraft:stone_bricks", {122, 122, 122}},
    {"minecraft:bricks", {151, 98, 83}},
    {"minecraft:obsidian", {15, 11, 25}},
    {"minecraft:end_stone", {220, 223, 158}},
    {"minecraft:clay", {161, 166, 179}},
    {"minecraft:dirt", {134, 96, 67}},
    {"minecraft:netherrack", {98, 38, 38}},
    {"minecraft:nether_bricks", {44, 22, 26}},
    {"minecraft:red_nether_bricks", {70, 7, 9}},
    {"minecraft:prismarine_bricks", {99, 172, 158}},
    {"minecraft:dark_prismarine", {52, 92, 76}},
    {"minecraft:purpur_block", {170, 126, 170}},
    {"minecraft:snow_block", {249, 254, 254}},
    {"minecraft:packed_ice", {142, 180, 250}},
    {"minecraft:blue_ice", {116, 168, 253}},
    {"minecraft:oak_planks", {162, 131, 79}},
    {"minecraft:spruce_planks", {115, 85, 49}},
    {"minecraft:birch_planks", {192, 175, 121}},
    {"minecraft:jungle_planks", {160, 115, 81}},
    {"minecraft:acacia_planks", {168, 90, 50}},
    {"minecraft:dark_oak_planks", {67, 43, 20}},
    {"minecraft:iron_block", {220, 220, 220}},
    {"minecraft:gold_block", {246, 208, 62}},
    {"minecraft:diamond_block", {98, 237, 228}},
    {"minecraft:emerald_block", {42, 203, 88}},
    {"minecraft:lapis_block", {31, 67, 140}},
    {"minecraft:redstone_block", {176, 25, 5}},
    {"minecraft:coal_block", {16, 16, 16}},
};

enum { BLOCKS = sizeof blocks / sizeof blocks[0] };
_Static_assert((int)BLOCKS <= (int)VXM_BLOCK_COLORS_MOST, "a matcher has room for all blocks");

const vxm_block_color *vxm_block_colors(size_t *count) {
  *count = BLOCKS;
  return blocks;
}

/* ---- CIELAB ---- */

/** The cube root, and near black the line that CIE 15 puts in its place. */
static double root(double t) {
  const double small = 6.0 / 29;
  return t > small * small * small ? cbrt(t) : t / (3 * small * small) + 4.0 / 29;
}

static void to_lab(double lab[3], const uint8_t rgb[3]) {
  static const double to_xyz[3][3] = {
      {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
  static const double white[3] = {0.9505, 1, 1.089};
  double f[3];
  for (int c = 0; c < 3; c++) {
    double sum = 0;
    for (int d = 0; d < 3; d++)
      sum += to_xyz[c][d] * vxm_srgb_decode(rgb[d] / 255.0);
    f[c] = root(sum / white[c]);
  }
  lab[0] = 116 * f[1] - 16;
  lab[1] = 500 * (f[0] - f[1]);
  lab[2] = 200 * (f[1] - f[2]);
}

void vxm_block_matcher_init(vxm_block_matcher *matcher) {
  memset(matcher->known, 0, sizeof matcher->known);
  for (size_t b = 0; b < BLOCKS; b++) {
    to_lab(matcher->lab[b], blocks[b].rgb);
    matcher->barred[b] = false;
  }
}

static size_t find_nearest(const vxm_block_matcher *matcher, const uint8_t rgb[3]) {
  double lab[3], least = HUGE_VAL;
  size_t found = 0;
  to_lab(lab, rgb);
  for (size_t b = 0; b < BLOCKS; b++) {
    double square = 0;
    for (int c = 0; c < 3; c++)
      square += (lab[c] - matcher->lab[b][c]) * (lab[c] - matcher->lab[b][c]);
    if (square < least && !matcher->barred[b]) {
      least = square;
      found = b;
    }
  }
  return found;
}

size_t vxm_block_match(vxm_block_matcher *matcher, const uint8_t rgb[3]) {
  enum { KNOWN = sizeof matcher->known / sizeof matcher->known[0] };
  uint32_t key = UINT32_C(1) << 24 | (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
  size_t slot = (key * UINT32_C(2654435761) >> 12) % KNOWN;
  if (matcher->known[slot].key != key) {
    matcher->known[slot].block = (uint16_t)find_nearest(matcher, rgb);
    matcher->known[slot].key = key;
  }
  return matcher->known[slot].block;
}
