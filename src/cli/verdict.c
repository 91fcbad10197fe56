/* SPDX-License-Identifier: BSD-3-Clause */
/** What is wrong with a mesh in a sentence, and which command mends it. */
#include "cli/defects.h"

#include <inttypes.h>
#include <string.h>

/** "3 holes" after `text`, "1 hole" of one. */
static void count(char *text, const char *before, int64_t number, const char *one, const char *many) {
  size_t length = strlen(text);
  snprintf(text + length, CLI_SENTENCE - length, "%s%" PRId64 " %s", before, number,
           number == 1 ? one : many);
}

static void add(char *text, const char *more) {
  size_t length = strlen(text);
  snprintf(text + length, CLI_SENTENCE - length, "%s", more);
}

static void say_open(char *text, const vxm_census *census, const cli_openings *openings) {
  /* where all faces are doubled every edge has an even number of them */
  add(text, census->closed ? "open once doubled faces are merged" : "open");
  if (census->nonfinite_vertices > 0)
    count(text, " without the faces of ", census->nonfinite_vertices, "vertex that is not finite",
          "vertices that are not finite");
  add(text, ": ");
  if (!openings->known || openings->sheets + openings->holes == 0) {
    if (census->boundary_edges > 0)
      count(text, "", census->boundary_edges, "open edge", "open edges");
    else
      add(text, "edges with three faces or another odd number");
    add(text, openings->known ? ", which repair closes"
                              : "; repair --level closed fills holes and thickens sheets");
    return;
  }
  bool sheets = openings->sheets > 0, holes = openings->holes > 0;
  if (sheets)
    count(text, "", openings->sheets, "sheet", "sheets");
  if (holes)
    count(text, sheets ? " and " : "", openings->holes, "hole", "holes");
  add(text, "; repair --level closed ");
  add(text, holes ? "fills the holes" : "");
  add(text, sheets ? (holes ? " and thickens the sheets" : "thickens the sheets") : "");
}

/** What repair removes or turns by itself. */
static bool say_unclean(char *text, const vxm_census *census) {
  int64_t repeated = census->duplicate_faces + census->opposite_duplicate_faces;
  if (census->nonfinite_vertices > 0)
    count(text, "closed, but with ", census->nonfinite_vertices, "vertex that is not finite",
          "vertices that are not finite");
  else if (repeated > 0)
    count(text, "closed, but with ", repeated, "repeated face", "repeated faces");
  else if (census->degenerate_faces > 0) {
    count(text, "closed, but with ", census->degenerate_faces, "face without area", "faces without area");
    add(text, "; repair removes those that close no gap"); /* the others it needs: they stay */
    return true;
  } else if (census->inconsistent_edges > 0)
    add(text, "closed, but faces are turned against each other");
  else
    return false;
  add(text, "; repair mends that");
  return true;
}

const char *cli_verdict(char text[CLI_SENTENCE], const vxm_census *census, const cli_openings *openings,
                        int64_t intersections) {
  text[0] = '\0';
  if (census->faces == 0)
    add(text, "empty: there is no face");
  else if (openings->known && openings->empty)
    add(text,
        "empty: no face has finite vertices and an area beside the size of the whole; repair leaves none");
  else if (!census->closed || (openings->known && openings->sheets + openings->holes > 0))
    say_open(text, census, openings);
  else if (census->nonmanifold_edges > 0) {
    count(text, "closed, but ", census->nonmanifold_edges, "edge joins", "edges join");
    add(text, " more than two faces; repair --level manifold cuts them apart");
  } else if (!say_unclean(text, census)) {
    add(text, "closed: every edge has two faces");
    if (intersections > 0)
      add(text, ", but some cut through others; repair --level solid unites the parts");
    else if (intersections == 0)
      add(text, ", and none cuts through another");
  }
  return text;
}
