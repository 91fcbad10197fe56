// SPDX-License-Identifier: BSD-3-Clause
/**
 * What a CAD importer in C++17 does with an assembly: read it at a tolerance, take it apart by the names of
 * its parts, repair each as far as it goes, and voxelize all of them into one space; with progress, a time
 * limit, and exceptions that pass the library unharmed.
 *
 *   import_parts FILE [--deflection SHARE] [--weld DISTANCE] [--resolution N] [--seconds S]
 */
#include <voxmend.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

// ---- The library's objects, owned; its errors, thrown ----

template <auto destroy> struct destroyer {
  template <typename object> void operator()(object *pointer) const {
    destroy(pointer);
  }
};
using context_ptr = std::unique_ptr<vxm_context, destroyer<vxm_context_destroy>>;
using mesh_ptr = std::unique_ptr<vxm_mesh, destroyer<vxm_mesh_destroy>>;
using grid_ptr = std::unique_ptr<vxm_grid, destroyer<vxm_grid_destroy>>;

struct failure : std::runtime_error {
  failure(vxm_status code, const char *text) : std::runtime_error(text), status(code) {
  }
  vxm_status status;
};

struct cancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** Listens to the library. No exception may leave a callback: it is kept, and thrown again when the call is
 * back. */
class listener {
public:
  explicit listener(double seconds) : limit(seconds), start(std::chrono::steady_clock::now()) {
  }

  static int on_progress(const char *phase, double fraction, void *payload) noexcept {
    auto *self = static_cast<listener *>(payload);
    try {
      self->tell(phase, fraction);
      return 0;
    } catch (...) {
      self->kept = std::current_exception();
      return 1;
    }
  }

  void throw_kept() {
    if (kept)
      std::rethrow_exception(std::exchange(kept, nullptr));
  }

private:
  /** Where an importer would move its bar, and look at its button. */
  void tell(const char *phase, double fraction) {
    std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    if (limit >= 0 && passed.count() >= limit)
      throw cancelled(std::string("time is up while ") + phase);
    if (shown != phase && fraction > 0 && passed.count() > 1)
      std::fprintf(stderr, "%s ...\n", (shown = phase).c_str());
  }

  double limit;
  std::chrono::steady_clock::time_point start;
  std::string shown;
  std::exception_ptr kept;
};

/** Takes what a call gives: `make` gets where the object goes, and where the error does. */
template <typename owner, typename maker> owner take(listener &heard, maker make) {
  typename owner::pointer made = nullptr;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = make(&made, &error);
  owner result(made);
  heard.throw_kept();
  if (status != VXM_OK)
    throw failure(status, error.text);
  return result;
}

// ---- The importer ----

struct settings {
  const char *path = nullptr;
  double deflection = 0, weld = 0, seconds = -1;
  int64_t resolution = 64;
};

struct part {
  std::string name;
  mesh_ptr mesh;
  int64_t faces = 0, voxels = 0;
  const char *level = "";
  double volume = 0, moved = 0;
};

/** The mesh of the faces of one name, with the vertices that they use. */
mesh_ptr faces_of(const vxm_mesh *all, uint32_t tag, vxm_context *context, listener &heard) {
  const uint32_t *tags = vxm_mesh_face_tags(all), *indices = vxm_mesh_indices(all);
  const uint64_t *offsets = vxm_mesh_offsets(all);
  const double *points = vxm_mesh_vertices(all);
  std::vector<int64_t> number(static_cast<size_t>(vxm_mesh_vertex_count(all)), -1), ends{0};
  std::vector<double> vertices;
  std::vector<int64_t> corners;
  for (int64_t f = 0; f < vxm_mesh_face_count(all); f++) {
    if (tags && tags[f] != tag)
      continue;
    for (uint64_t c = offsets[f]; c < offsets[f + 1]; c++) {
      int64_t &at = number[indices[c]];
      if (at < 0) {
        at = static_cast<int64_t>(vertices.size() / 3);
        vertices.insert(vertices.end(), points + 3 * size_t{indices[c]}, points + 3 * size_t{indices[c]} + 3);
      }
      corners.push_back(at);
    }
    ends.push_back(static_cast<int64_t>(corners.size()));
  }
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = vertices.data();
  arrays.vertex_count = static_cast<int64_t>(vertices.size() / 3);
  arrays.indices = corners.data();
  arrays.index_count = static_cast<int64_t>(corners.size());
  arrays.offsets = ends.data();
  arrays.face_count = static_cast<int64_t>(ends.size()) - 1;
  return take<mesh_ptr>(
      heard, [&](vxm_mesh **out, vxm_error *error) { return vxm_mesh_create(out, context, &arrays, error); });
}

bool is_at(const vxm_mesh *mesh, const vxm_repair_options &options, listener &heard) {
  vxm_verification found = VXM_VERIFICATION_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_mesh_verify(&found, mesh, &options, &error);
  heard.throw_kept();
  if (status != VXM_OK)
    throw failure(status, error.text);
  return found.reached;
}

/** Repairs a part to the highest level that it reaches without being changed beyond what is tolerated. */
void repair(part &one, const settings &wanted, listener &heard) {
  static const char *const names[] = {"clean", "manifold", "closed"};
  for (int level = VXM_LEVEL_CLOSED; level >= VXM_LEVEL_CLEAN; level--) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = static_cast<vxm_level>(level);
    options.weld = wanted.weld > 0 ? VXM_WELD_TOLERANCE : VXM_WELD_AUTO;
    options.weld_tolerance = wanted.weld;
    options.sheets = VXM_SHEETS_KEEP; // as it was drawn: what is open is not to become a plate
    options.max_change = 0.05;        // of volume or bounds: a repair that does more is none
    options.part_changes = true;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    vxm_census after = VXM_CENSUS_INIT;
    report.after = &after;
    try {
      mesh_ptr mended = take<mesh_ptr>(heard, [&](vxm_mesh **out, vxm_error *error) {
        return vxm_mesh_repair(out, &report, one.mesh.get(), &options, error);
      });
      if (!is_at(mended.get(), options, heard))
        continue;
      one.mesh = std::move(mended);
      one.level = names[level];
      one.volume = after.closed ? after.volume : 0;
      one.moved = report.max_displacement;
      return;
    } catch (const failure &why) {
      if (why.status != VXM_ERROR_UNREACHED && why.status != VXM_ERROR_UNAVAILABLE)
        throw; // nothing that a lower level would mend
    }
  }
  one.level = "as it came";
}

void voxelize(part &one, const vxm_space &space, listener &heard) {
  vxm_space_options same = VXM_SPACE_OPTIONS_INIT;
  same.like = &space;
  grid_ptr grid = take<grid_ptr>(heard, [&](vxm_grid **out, vxm_error *error) {
    return vxm_voxelize(out, nullptr, one.mesh.get(), &same, nullptr, error);
  });
  one.voxels = vxm_grid_count(
      grid.get()); // an importer would keep the grid, or vxm_grid_unpack it into bytes of its own
}

void import_file(const settings &wanted) {
  listener heard(wanted.seconds);
  vxm_context_options how = VXM_CONTEXT_OPTIONS_INIT;
  how.progress = listener::on_progress;
  how.payload = &heard;
  auto context = take<context_ptr>(
      heard, [&](vxm_context **out, vxm_error *error) { return vxm_context_create(out, &how, error); });

  vxm_mesh_read_options reading = VXM_MESH_READ_OPTIONS_INIT;
  reading.deflection = wanted.deflection;
  auto all = take<mesh_ptr>(heard, [&](vxm_mesh **out, vxm_error *error) {
    return vxm_mesh_read_with(out, context.get(), wanted.path, &reading, error);
  });
  for (int64_t i = 0; i < vxm_mesh_warning_count(all.get()); i++)
    std::fprintf(stderr, "import_parts: %s\n", vxm_mesh_warning(all.get(), i));

  vxm_space_options fitting = VXM_SPACE_OPTIONS_INIT;
  fitting.resolution[0] = wanted.resolution;
  vxm_space space;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_status status = vxm_space_fit(&space, all.get(), &fitting, &error); status != VXM_OK)
    throw failure(status, error.text);

  int64_t tags = vxm_mesh_tag_count(all.get());
  for (int64_t t = 0; t < (tags > 0 ? tags : 1); t++) {
    part one;
    one.name = tags > 0 ? vxm_mesh_tag_name(all.get(), t) : "unnamed";
    one.mesh = faces_of(all.get(), static_cast<uint32_t>(t), context.get(), heard);
    one.faces = vxm_mesh_face_count(one.mesh.get());
    if (one.faces == 0)
      continue;
    repair(one, wanted, heard);
    voxelize(one, space, heard);
    std::printf("%s: %lld faces, %s, volume %.6g, moved %.3g, %lld voxels\n", one.name.c_str(),
                static_cast<long long>(one.faces), one.level, one.volume, one.moved,
                static_cast<long long>(one.voxels));
  }
}

bool parse(settings &out, int argc, char **argv) {
  for (int i = 1; i < argc; i++) {
    bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "--deflection") == 0 && has_value)
      out.deflection = std::atof(argv[++i]);
    else if (std::strcmp(argv[i], "--weld") == 0 && has_value)
      out.weld = std::atof(argv[++i]);
    else if (std::strcmp(argv[i], "--resolution") == 0 && has_value)
      out.resolution = std::atoll(argv[++i]);
    else if (std::strcmp(argv[i], "--seconds") == 0 && has_value)
      out.seconds = std::atof(argv[++i]);
    else if (argv[i][0] != '-' && !out.path)
      out.path = argv[i];
    else
      return false;
  }
  return out.path;
}

} // namespace

int main(int argc, char **argv) {
  settings wanted;
  if (!parse(wanted, argc, argv)) {
    std::fprintf(
        stderr,
        "usage: import_parts FILE [--deflection SHARE] [--weld DISTANCE] [--resolution N] [--seconds S]\n");
    return 2;
  }
  try {
    import_file(wanted);
    return 0;
  } catch (const cancelled &why) {
    std::fprintf(stderr, "import_parts: %s\n", why.what());
    return 3;
  } catch (const std::exception &why) {
    std::fprintf(stderr, "import_parts: %s\n", why.what());
    return 1;
  }
}
