/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of a run share: its state, and the steps of a mesh from being given out to its end. */
#ifndef VXM_BATCH_RUN_H
#define VXM_BATCH_RUN_H

#include "batch/replay.h"
#include "batch/tally.h"

enum { BATCH_JOBS_MAX = 512, BATCH_HASHES = 64 };

/** A child at work. */
typedef struct batch_slot {
  bool is_used, is_alone;
  int64_t items[BATCH_HASHES]; /**< one whose outputs are made, or those whose files are digested */
  int count;
  bool is_hashing;
} batch_slot;

typedef struct run {
  const batch_settings *settings;
  batch_manifest *manifest;
  batch_content *contents;
  bool *needs_more; /**< items that ran out of memory beside others, and have one more try alone */
  batch_tally *tally;
  batch_error *error;
  batch_journal journal;
  batch_zygote zygote;
  batch_slot *slots;               /**< as many as children may be at work */
  int in_flight, losses, refusals; /**< losses: of zygotes, one after another; refusals: of processes */
  bool is_broken;
  double memory_left, memory_seen_ms; /**< as a share, and when that was */
  char *ending;                       /**< BATCH_ENDING_BYTES */
} run;

/** Whether nothing new is to be begun. */
bool batch_run_stops(const run *r);
/** What a source of work says. */
typedef enum batch_turn { BATCH_NOTHING_LEFT, BATCH_GIVEN_OUT, BATCH_LATER } batch_turn;
/** Gives out one piece, if there is one and it can be had now. */
typedef batch_turn batch_source(run *r, void *payload);
/**
 * Lets children work at what a source has, so many at a time, until there is nothing left and all have ended,
 * or the run stops.
 *
 * @param waits_for a descriptor that the source waits for where it said "later"; -1 = none
 */
void batch_run_source(run *r, batch_source *source, void *payload, int jobs, const int *waits_for);

/** Makes the folders that an output's name goes through. False with errno. */
bool batch_make_folders(run *r, const char *name);
/* Each gives a piece to a child; false where the run is broken. */
bool batch_give_out(run *r, int64_t item, int input, bool is_alone);
bool batch_give_hashes(run *r, const int64_t *items, int count);

/** Writes an item's end into the journal, and counts it. The record is given away. */
bool batch_end_item(run *r, int64_t item, batch_status status, json_t *record);
/** Notes the digest of an item's bytes; "" where they cannot be had, or say too little. */
void batch_take_hash(run *r, int64_t item, const char *digest);
/** What a child has said when it ended; NULL where it said nothing that makes sense. */
void batch_take_ending(run *r, batch_slot *slot, const batch_ending *ending);
/** Sets is_broken; the error is told already. */
bool batch_break(run *r);

/* ---- Members of archives ---- */

/** A member that is asked for. Several items may have one place: hard links. */
typedef struct batch_wanted {
  int64_t place, item;
} batch_wanted;

/** Puts them into the order of the archive. */
void batch_wanted_sort(batch_wanted *members, int64_t count);
/** Index of the first of them that has this place, or what would be behind it. */
int64_t batch_wanted_find(const batch_wanted *members, int64_t count, int64_t place);
/** The bytes that an unpacked mesh may take in memory. */
uint64_t batch_member_room(const batch_settings *settings);

/* ---- Duplicates ---- */

/** Digests the files that might be the same as another's, and finds out which are. */
void batch_find_duplicates(run *r);
/** Gives duplicates the outputs of their originals. */
void batch_link_duplicates(run *r);

#endif
