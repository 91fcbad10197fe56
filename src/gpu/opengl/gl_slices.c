/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Slicing as published: every triangle makes a tetrahedron with the apex of its part, and slice after slice
 * the cross-sections of those that meet it are drawn with XOR into a layer of the presence buffer (Rueda et
 * al., section 5; Ogayar et al., section III-B). The CPU lists the triangles of each slice.
 */
#include "base/rng.h"
#include "gpu/opengl/opengl.h"

#include <string.h>

enum {
  LAYERS = 64,        /**< slices drawn before they are packed */
  RANDOM = 3 * 16384, /**< numbers in the circular buffer */
  LIST_MOST = 1 << 24 /**< triangles listed at a time */
};

/** Presence buffers are no larger than this. */
static const int64_t presence_most = INT64_C(64) << 20;

/** The uniform block of shaders/section.glsl. */
typedef struct slice_job {
  int32_t axes[3], bits;
  int32_t view[4];
  uint32_t random[4];
  float amount[4];
} slice_job;

typedef struct slicing {
  vxm_opengl *engine;
  const vxm_slab *slab;
  const vxm_parity_union_job *job;
  const vxm_disjoint_passes *passes;
  size_t triangle_begin, triangle_end; /**< places in the lists of the passes */
  vxm_slab_columns columns;            /**< axes and voxels of the slab */
  slice_job gl_job;
  int64_t begin, end;       /**< slices that are drawn together */
  size_t first[LAYERS + 1]; /**< of each slice: where its triangles begin in the list */
} slicing;

static uint32_t triangle_at(const slicing *s, size_t place) {
  return s->passes->ordered ? s->passes->order[place] : (uint32_t)(s->passes->first + place);
}

/* ---- Lists of triangles ---- */

/** Slices, of those drawn together, that the tetrahedron of a triangle may meet. */
static bool slices_of(const slicing *s, uint32_t triangle, int64_t *begin, int64_t *end) {
  const vxm_triangle_set *triangles = s->job->triangles;
  const vxm_lattice *lattice = &s->job->placed->lattice;
  int w = s->columns.axes[2];
  int64_t apex =
      vxm_snapped_points_at(s->job->placed, vxm_apex_of(triangles, triangles->part[triangle])).at[w];
  int64_t low = apex, high = apex + lattice->unit / 16; /* it is moved a little: shaders/section.glsl */
  for (int c = 0; c < 3; c++) {
    int64_t at = vxm_snapped_points_at(s->job->placed, triangles->corners[triangle][c]).at[w];
    low = vxm_min(low, at);
    high = vxm_max(high, at);
  }
  double most = s->engine->options.displacement * (double)lattice->unit;
  int64_t move = most > 0 ? (int64_t)(most < 0x1p40 ? most : 0x1p40) + 1 : 0;
  *begin = vxm_max(vxm_lattice_first(lattice, low - move), s->begin);
  *end = vxm_min(vxm_lattice_first(lattice, high + move), s->end);
  return *begin < *end;
}

static void count_triangles(slicing *s) {
  size_t count[LAYERS + 1] = {0}, sum = 0;
  for (size_t i = s->triangle_begin; i < s->triangle_end; i++) {
    int64_t begin, end;
    if (!slices_of(s, triangle_at(s, i), &begin, &end))
      continue;
    for (int64_t k = begin; k < end; k++)
      count[k - s->begin]++;
  }
  for (int64_t k = 0; k <= s->end - s->begin; k++) {
    s->first[k] = sum;
    sum += count[k];
  }
}

/** Lists triangles by slice; fewer slices are drawn together where the list would be long. */
static vxm_status list_triangles(slicing *s, vxm_error *error) {
  vxm_context *context = s->engine->base.context;
  count_triangles(s);
  while (s->first[s->end - s->begin] > LIST_MOST && s->end - s->begin > 1) {
    s->end = s->begin + (s->end - s->begin) / 2;
    count_triangles(s);
  }
  size_t total = s->first[s->end - s->begin], next[LAYERS];
  if (total > INT32_MAX / 6)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "one slice meets %zu triangles, more than one draw may have; use "
                    "--gl-method columns",
                    total);
  vxm_status status = VXM_OK;
  uint32_t *list = vxm_try_alloc(context, total, sizeof *list, &status, error);
  if (!list)
    return status;
  memcpy(next, s->first, sizeof next);
  for (size_t i = s->triangle_begin; i < s->triangle_end && total > 0; i++) {
    int64_t begin, end;
    uint32_t triangle = triangle_at(s, i);
    if (!slices_of(s, triangle, &begin, &end))
      continue;
    for (int64_t k = begin; k < end; k++)
      list[next[k - s->begin]++] = triangle;
  }
  status = vxm_gl_upload(s->engine, VXM_GL_LARGE, list, total * sizeof *list, error);
  vxm_free(context, list);
  return status;
}

/* ---- The presence buffer ---- */

static vxm_status reserve_presence(slicing *s, int64_t width, int64_t height, int64_t layers,
                                   vxm_error *error) {
  vxm_opengl *engine = s->engine;
  const vxm_gl *gl = &engine->context.gl;
  vxm_gl_presence *presence = &engine->presence;
  const vxm_gl_format *format = engine->format;
  if (presence->size[0] >= width && presence->size[1] >= height && presence->size[2] >= layers)
    return VXM_OK;
  vxm_gl_presence_release(engine);
  size_t bytes = (size_t)width * (size_t)height * (size_t)layers * format->bytes;
  vxm_status status = vxm_memory_take(engine->base.context, bytes, error);
  if (status != VXM_OK)
    return status;
  *presence = (vxm_gl_presence){.bytes = bytes, .size = {width, height, layers}};
  gl->GenTextures(1, &presence->texture);
  gl->GenFramebuffers(1, &presence->framebuffer);
  gl->BindTexture(GL_TEXTURE_2D_ARRAY, presence->texture);
  gl->TexStorage3D(GL_TEXTURE_2D_ARRAY, 1, format->internal, (GLsizei)width, (GLsizei)height,
                   (GLsizei)layers);
  gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  status = vxm_gl_check(gl, "opengl: making the presence buffer", error);
  if (status != VXM_OK)
    vxm_gl_presence_release(engine);
  return status;
}

/* ---- Drawing ---- */

static void clear_layer(const vxm_gl *gl, const vxm_gl_format *format) {
  static const GLuint zeros[4] = {0, 0, 0, 0};
  static const GLfloat black[4] = {0, 0, 0, 0};
  if (format->internal == GL_R8)
    gl->ClearBufferfv(GL_COLOR, 0, black);
  else
    gl->ClearBufferuiv(GL_COLOR, 0, zeros);
}

/** Draws each slice into its layer. */
static void draw_layers(slicing *s) {
  static const GLenum none = GL_NONE, colour = GL_COLOR_ATTACHMENT0;
  const vxm_gl *gl = &s->engine->context.gl;
  const vxm_gl_presence *presence = &s->engine->presence;
  const vxm_gl_format *format = s->engine->format;
  bool by_vertex = s->engine->options.gl_method == VXM_GL_TETRA_VERTEX;
  bool is_image = format->is_image;
  gl->BindFramebuffer(GL_FRAMEBUFFER, presence->framebuffer);
  if (is_image)
    gl->BindImageTexture(0, presence->texture, 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
  else {
    gl->Enable(GL_COLOR_LOGIC_OP);
    gl->LogicOp(GL_XOR);
  }
  for (int64_t k = 0; k < s->end - s->begin; k++) {
    GLsizei triangles = (GLsizei)(s->first[k + 1] - s->first[k]);
    gl->FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, presence->texture, 0, (GLint)k);
    gl->DrawBuffers(1, &colour);
    clear_layer(gl, format);
    if (is_image) {
      gl->DrawBuffers(1, &none);
      gl->Uniform1i(2, (GLint)k);
    }
    gl->Uniform1ui(0, (GLuint)s->first[k]);
    gl->Uniform1i(1, (GLint)(s->begin + k));
    if (triangles > 0)
      gl->DrawArrays(GL_TRIANGLES, 0, (by_vertex ? 6 : 3) * triangles);
  }
  gl->Disable(GL_COLOR_LOGIC_OP);
  gl->MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

/** Packs what is in the layers into bits. */
static vxm_status pack(slicing *s, vxm_error *error) {
  vxm_opengl *engine = s->engine;
  const vxm_gl *gl = &engine->context.gl;
  const vxm_window *window = s->slab->window;
  const int layout[3] = {window->layout.fast, window->layout.middle, window->layout.slow};
  GLuint places[3] = {0, 0, 0};
  vxm_status status = vxm_gl_use(engine, VXM_GL_PACK, error);
  if (status != VXM_OK)
    return status;
  for (int i = 0; i < 3; i++)
    for (GLuint k = 0; k < 3; k++)
      if (s->columns.axes[k] == layout[i])
        places[i] = k;
  const int32_t *view = s->gl_job.view, *first = s->columns.first;
  gl->BindTexture(GL_TEXTURE_2D_ARRAY, engine->presence.texture);
  vxm_gl_bind(engine, 3, VXM_GL_FLIPS);
  gl->Uniform4ui(0, (GLuint)(2 * s->slab->words), (GLuint)(2 * s->slab->row_words),
                 (GLuint)window->middle_dim, (GLuint)window->fast_dim);
  gl->Uniform4ui(1, places[0], places[1], places[2], 0);
  gl->Uniform4i(2, view[0] - first[0], view[1] - first[1], (GLint)s->begin - first[2], 0);
  gl->Uniform4i(3, view[2], view[3], (GLint)(s->end - s->begin), 0);
  vxm_gl_dispatch(gl, 2 * s->slab->words, false);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  return VXM_OK;
}

/** One viewport of the slices that are drawn together. */
static vxm_status draw_view(slicing *s, vxm_error *error) {
  vxm_opengl *engine = s->engine;
  bool by_vertex = engine->options.gl_method == VXM_GL_TETRA_VERTEX;
  vxm_status status = vxm_gl_upload(engine, VXM_GL_JOB, &s->gl_job, sizeof s->gl_job, error);
  if (status == VXM_OK)
    status = reserve_presence(s, s->gl_job.view[2], s->gl_job.view[3], s->end - s->begin, error);
  if (status == VXM_OK)
    status = vxm_gl_use(engine, by_vertex ? VXM_GL_DRAW_TETRA : VXM_GL_DRAW_SLICES, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 0, VXM_GL_JOB);
  vxm_gl_bind(engine, 0, VXM_GL_POINTS);
  vxm_gl_bind(engine, 1, VXM_GL_CORNERS);
  vxm_gl_bind(engine, 2, VXM_GL_RANDOM);
  vxm_gl_bind(engine, 3, VXM_GL_APEXES);
  vxm_gl_bind(engine, 4, VXM_GL_LARGE);
  engine->context.gl.Viewport(0, 0, s->gl_job.view[2], s->gl_job.view[3]);
  draw_layers(s);
  return pack(s, error);
}

/** All viewports of the slices from `begin` on that are drawn together. */
static vxm_status draw_slab(slicing *s, vxm_error *error) {
  const int32_t *first = s->columns.first, *last = s->columns.last;
  int64_t most = s->engine->base.info.viewport;
  int64_t area = vxm_min(most, last[0] - first[0]) * vxm_min(most, last[1] - first[1]);
  int64_t layers = vxm_min(vxm_min(LAYERS, s->engine->base.info.layers), last[2] - s->begin);
  s->end = s->begin + vxm_max(1, vxm_min(layers, presence_most / area));
  vxm_status status = list_triangles(s, error);
  for (int64_t v = first[1]; v < last[1] && status == VXM_OK; v += most)
    for (int64_t u = first[0]; u < last[0] && status == VXM_OK; u += most) {
      s->gl_job.view[0] = (int32_t)u;
      s->gl_job.view[1] = (int32_t)v;
      s->gl_job.view[2] = (int32_t)vxm_min(most, last[0] - u);
      s->gl_job.view[3] = (int32_t)vxm_min(most, last[1] - v);
      status = draw_view(s, error);
    }
  return status;
}

/** The circular buffer, which is filled once: its start is chosen by the seed. */
static vxm_status start_random(slicing *s, vxm_error *error) {
  vxm_opengl *engine = s->engine;
  vxm_rng rng = {1}, start = {engine->options.seed};
  s->gl_job.random[0] = RANDOM;
  s->gl_job.random[1] = (uint32_t)vxm_rng_below(&start, RANDOM);
  s->gl_job.amount[0] = (float)engine->options.displacement;
  if (engine->buffers[VXM_GL_RANDOM].bytes > 0)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  float *value = vxm_alloc(engine->base.context, RANDOM, sizeof *value, &local);
  for (int i = 0; value && i < RANDOM; i++)
    value[i] = (float)(2 * vxm_rng_unit(&rng) - 1);
  vxm_status status =
      value ? vxm_gl_upload(engine, VXM_GL_RANDOM, value, RANDOM * sizeof *value, &local) : local.code;
  vxm_free(engine->base.context, value);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status merge(slicing *s, vxm_gl_buffer_id into, bool is_added, vxm_error *error) {
  vxm_opengl *engine = s->engine;
  const vxm_gl *gl = &engine->context.gl;
  vxm_status status = vxm_gl_use(engine, VXM_GL_MERGE, error);
  if (status != VXM_OK)
    return status;
  vxm_gl_bind(engine, 3, VXM_GL_FLIPS);
  vxm_gl_bind(engine, 5, into);
  gl->Uniform1ui(0, (GLuint)(2 * s->slab->words));
  gl->Uniform1ui(1, is_added);
  vxm_gl_dispatch(gl, 2 * s->slab->words, false);
  gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return VXM_OK;
}

static vxm_status draw_pass(slicing *s, size_t pass, vxm_gl_buffer_id into, vxm_error *error) {
  vxm_status status = VXM_OK;
  double all = (double)(s->columns.last[2] - s->columns.first[2]);
  for (s->begin = s->columns.first[2]; s->begin < s->columns.last[2] && status == VXM_OK; s->begin = s->end) {
    status = draw_slab(s, error);
    if (status == VXM_OK)
      status = vxm_gl_check(&s->engine->context.gl, "opengl: drawing slices", error);
    double done = (double)pass + (double)(s->end - s->columns.first[2]) / all;
    if (status == VXM_OK)
      status =
          vxm_progress(s->engine->base.context, "drawing slices", done / (double)s->passes->count, error);
  }
  if (status == VXM_OK && s->job->has_voxels)
    status = vxm_gl_touch(s->engine, s->slab, s->passes, pass, error);
  return status == VXM_OK ? merge(s, into, pass > 0, error) : status;
}

bool vxm_gl_can_slice(const vxm_parity_union_job *job) {
  const vxm_split *split = &job->triangles->split;
  return (job->roles & VXM_ROLE_CONE) || job->part_end <= split->kind_end[VXM_PART_CLOSED] ||
         ((job->roles & VXM_ROLE_CAP) && job->part_end <= split->kind_end[VXM_PART_CAPPED]);
}

vxm_status vxm_gl_slices(vxm_opengl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                         const vxm_disjoint_passes *passes, vxm_gl_buffer_id into, vxm_error *error) {
  slicing s = {.engine = engine, .slab = slab, .job = job, .passes = passes};
  size_t bytes = slab->words * sizeof(uint64_t);
  if (!engine->can_pull)
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE,
                    "the vertex shaders of %s read no buffers; use --gl-method columns",
                    engine->base.info.renderer);
  if (job->placed->wide)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "a vertex lies too far outside the grid for slices; use --gl-method columns");
  vxm_parity_union_job turned = *job;
  turned.axis = engine->options.slice_axis;
  s.columns = vxm_slab_columns_of(slab, &turned);
  memcpy(s.gl_job.axes, s.columns.axes, sizeof s.gl_job.axes);
  s.gl_job.bits = s.columns.bits;
  vxm_status status = vxm_gl_reserve_flips(engine, bytes, error);
  if (status == VXM_OK)
    status = vxm_gl_reserve(engine, into, bytes, error);
  if (status == VXM_OK)
    status = start_random(&s, error);
  for (size_t p = 0; p < passes->count && status == VXM_OK; p++) {
    s.triangle_end = passes->triangle_end[p];
    status = draw_pass(&s, p, into, error);
    s.triangle_begin = s.triangle_end;
  }
  return status;
}
