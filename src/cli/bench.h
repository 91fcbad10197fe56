/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of `voxmend bench` share: the phases, how they are measured and how that is shown. */
#ifndef VXM_CLI_BENCH_H
#define VXM_CLI_BENCH_H

#include "cli/repair_common.h"
#include "voxmend/experimental.h"

enum {
  BENCH_LIST_MAX = 32,
  BENCH_PHASES_MAX = 64,
  BENCH_ENGINES_MAX = 8,
  BENCH_RUNS_LEAST = 5,
  BENCH_RUNS_MOST = 10000
};

/* ---- What is asked for ---- */

typedef struct bench_plan {
  const char *path, *plot;
  char engines[BENCH_ENGINES_MAX][48]; /**< who makes the grids; the first one does what others cannot, too */
  vxm_engine_options engine_options[BENCH_ENGINES_MAX]; /**< of each: how it is to make solids */
  int engine_count;
  int64_t resolutions[BENCH_LIST_MAX], threads[BENCH_LIST_MAX]; /**< ascending, none twice */
  int resolution_count, thread_count;
  bool chosen[BENCH_PHASES_MAX]; /**< by position in bench_phases */
  bool forced;                   /**< the phases were named: none is left out for being slow */
  bool augment;                  /**< the phases that make variants, instead of the others */
  double displace;
  double time_ms; /**< each is repeated for at least as long as this */
} bench_plan;

/* ---- Phases (bench_phases.c) ---- */

typedef struct bench_fill bench_fill;
typedef struct bench_augment bench_augment;

/** What the phases work on, for one number of threads. */
typedef struct bench_stage {
  cli_run *cli;
  const char *path;
  int threads;
  vxm_mesh *raw, *mesh;                   /**< as read, and repaired */
  vxm_space space;                        /**< of the present resolution */
  vxm_grid *grid;                         /**< of that space; made when a phase asks for it */
  vxm_engine *engines[BENCH_ENGINES_MAX]; /**< as in the plan */
  int engine;                             /**< of the present phase: a number of the plan */
  vxm_model *model;                       /**< of the present phase */
  bench_fill *fill;                       /**< of the present phase */
  void *values;                           /**< a number per voxel, of the present phase */
  vxm_baseline_options baseline;          /**< of the present phase, and what its last run came to */
  vxm_baseline_report baseline_report;
  vxm_published *published; /**< of the present phase, with value_count voxels */
  size_t value_count;
  bench_augment *augment; /**< of the present phase */
  int64_t variants;       /**< that each of its runs makes: times are for one; 0 = does not apply */
  double displace;        /**< by how much they are displaced */
  int64_t run;            /**< number of the present run */
  vxm_mesh *made_mesh;    /**< what the run has made: dropped when the clock has stopped */
  vxm_model *made_model;
  vxm_sparse *made_sparse;
} bench_stage;

/** What a run has made. */
typedef struct bench_output {
  uint64_t bytes;
  int64_t voxels;
  json_t *figures; /**< what else there is to tell, or NULL; the taker's */
} bench_output;

/** When a phase is measured, unless it is named. */
typedef enum bench_kind {
  BENCH_USUAL = 0,
  BENCH_AUGMENT, /**< with --augment, in place of the others */
  BENCH_OPENCL,  /**< where an engine of OpenCL is named, and by such engines only */
  BENCH_BASELINE /**< where it is named: for comparison with papers */
} bench_kind;

typedef struct bench_phase {
  const char *name; /**< NULL ends the table */
  const char *help;
  bool per_grid;  /**< measured at each resolution, else once */
  bool by_engine; /**< measured with each engine, else with the first */
  bench_kind kind;
  double most_ms;                          /**< left out where a run would take longer; 0 = never */
  vxm_status (*begin)(bench_stage *stage); /**< makes what a run needs, off the clock; NULL = nothing */
  vxm_status (*run)(bench_stage *stage);   /**< what is measured */
  void (*tell)(bench_output *out, const bench_stage *stage); /**< after a run; NULL = nothing to tell */
} bench_phase;

extern const bench_phase bench_phases[];

/** Makes the engines, reads and repairs the mesh. The stage's context is cli->context. */
vxm_status bench_stage_open(bench_stage *stage, const bench_plan *plan);
/** Sets the resolution; drops the grid and the numbers of the one before. */
vxm_status bench_stage_resize(bench_stage *stage, int64_t resolution);
/** Drops what a run has made. */
void bench_stage_drop(bench_stage *stage);
/** Drops what the phase's begin has made; the grid stays for the next phase. */
void bench_stage_end_phase(bench_stage *stage);
void bench_stage_close(bench_stage *stage);
/* ---- Filling memory (bench_fill.c) ---- */

/** Makes a block of memory as the grids have it, and threads that fill a share of it each. Fills
 * cli->error. */
vxm_status bench_fill_create(bench_fill **out, cli_run *cli, uint64_t bytes, int threads);
/** Fills the block once. */
void bench_fill_run(bench_fill *fill);
void bench_fill_destroy(bench_fill *fill);

/* ---- Making variants for training (bench_augment.c) ---- */

vxm_status bench_begin_standard(bench_stage *stage);
vxm_status bench_run_standard(bench_stage *stage);
vxm_status bench_begin_batch(bench_stage *stage);
vxm_status bench_run_batch(bench_stage *stage);
vxm_status bench_begin_direct(bench_stage *stage);
vxm_status bench_run_direct(bench_stage *stage);
/** The bytes that a variant takes in files. */
void bench_tell_augment(bench_output *out, const bench_stage *stage);
void bench_augment_end(bench_stage *stage);

/* ---- A published OpenCL program (bench_opencl.c) ---- */

bool bench_names_opencl(const bench_plan *plan);
/** Whether an engine of the plan has a say in a phase. Where none is of OpenCL, the first one is asked for
 * what needs it, so that the table has the reason why it is left out. */
bool bench_takes_part(const bench_plan *plan, const bench_phase *phase, int engine);
vxm_status bench_begin_published_facets(bench_stage *stage);
vxm_status bench_begin_published_voxels(bench_stage *stage);
vxm_status bench_run_published(bench_stage *stage);
vxm_status bench_begin_transfer(bench_stage *stage);
vxm_status bench_run_transfer_read(bench_stage *stage);
vxm_status bench_run_transfer_map(bench_stage *stage);
void bench_tell_published(bench_output *out, const bench_stage *stage);

/** How long the stages of a run on an OpenCL device take, measured off the clock in a run of its own; NULL
 * where the engine or the phase has none. */
json_t *bench_stages(bench_stage *stage, const bench_phase *phase);

/* ---- Published methods (bench_baseline.c) ---- */

vxm_status bench_begin_fang_chen(bench_stage *stage);
vxm_status bench_begin_chen_tu(bench_stage *stage);
vxm_status bench_begin_tetra_listed(bench_stage *stage);
vxm_status bench_begin_tetra_full(bench_stage *stage);
vxm_status bench_begin_tetra_anew(bench_stage *stage);
vxm_status bench_begin_tetra_layers(bench_stage *stage);
vxm_status bench_begin_density(bench_stage *stage);
vxm_status bench_begin_simple(bench_stage *stage);
vxm_status bench_begin_specialized(bench_stage *stage);
vxm_status bench_begin_sorted(bench_stage *stage);
vxm_status bench_begin_simple_thin(bench_stage *stage);
vxm_status bench_begin_specialized_thin(bench_stage *stage);
vxm_status bench_begin_sorted_thin(bench_stage *stage);
vxm_status bench_begin_zhang(bench_stage *stage);
vxm_status bench_begin_eisemann(bench_stage *stage);
vxm_status bench_run_baseline(bench_stage *stage);
void bench_tell_baseline(bench_output *out, const bench_stage *stage);

/* ---- Measuring (bench_measure.c) ---- */

typedef struct bench_result {
  const bench_phase *phase;
  int64_t resolution; /**< 0 for what does not depend on it */
  int threads;
  int engine; /**< a number of the plan */
  double median_ms, least_ms;
  int64_t runs;
  uint64_t bytes;     /**< of what is made, or of the file for `load`; 0 = does not apply */
  int64_t voxels;     /**< set voxels; those covered in part too, and those inside */
  double of_memset;   /**< median over that of memset of as many bytes by as many threads; 0 = not measured */
  char left_out[560]; /**< why it was not measured, or "" */
  json_t *figures;    /**< of the first run, or NULL */
} bench_result;

typedef struct bench_memory {
  int64_t resolution;
  int threads;
  uint64_t peak_bytes; /**< largest number of bytes held by the context so far */
} bench_memory;

typedef struct bench_results {
  bench_result *items;
  int count, capacity;
  bench_memory memory[BENCH_LIST_MAX * BENCH_LIST_MAX];
  int memory_count;
} bench_results;

void bench_results_drop(bench_results *results);
/** The result of a phase, or NULL if there is none that was measured. */
const bench_result *bench_find(const bench_results *results, const char *phase, int64_t resolution,
                               int threads, int engine);
/**
 * Measures a phase, or decides to leave it out, and adds the result. A phase that does not fit the memory is
 * left out too.
 */
vxm_status bench_measure(bench_results *results, bench_stage *stage, const bench_plan *plan,
                         const bench_phase *phase, int64_t resolution);

/* ---- The machine (bench_machine.c) ---- */

typedef struct bench_machine {
  char processor[128], architecture[32], system[128], compiler[96], huge_pages[16];
  int cores;
  vxm_cpu_level vectors; /**< that are used */
  uint64_t memory_bytes;
  struct {
    int level;
    char type[16];
    uint64_t bytes;
  } caches[8]; /**< those of the first processor */
  int cache_count;
} bench_machine;

/** Names of vxm_cpu_level, and NULL. */
extern const char *const bench_cpu_names[];

void bench_machine_read(bench_machine *out);
json_t *bench_machine_json(const bench_machine *machine);
/** Bytes that the process held at most, as the system counts them. */
uint64_t bench_peak_rss(void);

/* ---- Showing (bench_report.c, bench_plot.c) ---- */

/** What the results are of. */
typedef struct bench_subject {
  bench_machine machine;
  cli_input input;     /**< its mesh is gone */
  vxm_census repaired; /**< of that mesh */
  uint64_t peak_bytes;
} bench_subject;

void bench_print(const cli_run *cli, const bench_plan *plan, const bench_subject *subject,
                 const bench_results *results);
json_t *bench_json(const cli_run *cli, const bench_plan *plan, const bench_subject *subject,
                   const bench_results *results);
/** Draws resolution against milliseconds, both on logarithmic scales, as SVG. */
void bench_plot(FILE *file, const bench_plan *plan, const bench_subject *subject,
                const bench_results *results);

#endif
