/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A triangle to draw, in place of a given one, that covers every pixel whose centre the given one covers,
 * whatever the rasterizer's rounding: `grow` pixels wider, well above the 1/256 pixel that it may round to.
 * It is one triangle always, so that no pixel is drawn twice.
 */
vec2 cover_corner(vec2 p[3], int which, float grow) {
  vec2 edge[3];
  float length_of[3], sine = 1.0;
  int longest = 0;
  for (int e = 0; e < 3; e++) {
    edge[e] = p[(e + 1) % 3] - p[e];
    length_of[e] = length(edge[e]);
    longest = length_of[e] > length_of[longest] ? e : longest;
  }
  for (int c = 0; c < 3; c++) {
    vec2 to = edge[c], back = -edge[(c + 2) % 3];
    float across = abs(to.x * back.y - to.y * back.x), lengths = length_of[c] * length_of[(c + 2) % 3];
    sine = lengths > 0.0 ? min(sine, across / lengths) : 0.0;
  }
  if (sine > 0.1) { /* each corner moves out along its bisector */
    vec2 to = edge[which] / length_of[which], back = -edge[(which + 2) % 3] / length_of[(which + 2) % 3];
    return p[which] - (to + back) * (grow / abs(to.x * back.y - to.y * back.x));
  }
  /* A sliver: half of a box about its longest edge that is twice as long and twice as wide. */
  vec2 along = length_of[longest] > 0.0 ? edge[longest] / length_of[longest] : vec2(1.0, 0.0);
  vec2 aside = vec2(-along.y, along.x), tip = p[(longest + 2) % 3] - p[longest];
  float height = dot(tip, aside), reach = dot(tip, along);
  vec2 low = vec2(min(reach, 0.0), min(height, 0.0)) - grow;
  vec2 high = vec2(max(reach, length_of[longest]), max(height, 0.0)) + grow;
  vec2 at = which == 0 ? low : which == 1 ? vec2(2.0 * high.x - low.x, low.y) : vec2(low.x, 2.0 * high.y - low.y);
  return p[longest] + along * at.x + aside * at.y;
}
