# SPDX-License-Identifier: BSD-3-Clause
"""Makes the binding voxmend._voxmend from voxmend.h and what it includes, so that the two cannot differ.

The library is found by pkg-config. VOXMEND_INCLUDE and VOXMEND_LIB, the folders of voxmend.h and of libvoxmend.so, take
precedence: for a library that was built and not installed. When the package runs, the system finds the library as any other
(ldconfig, LD_LIBRARY_PATH); VOXMEND_RPATH=1 has the extension remember the folder in which it was found.

A package that brings the library (build_library.py) has it in its own folder, and the extension looks for it there alone.
"""
import os
import re
import shlex
import subprocess
import sys

from cffi import FFI

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import build_library


def find_library():
    """Folders of headers and libraries."""
    include, lib = os.environ.get("VOXMEND_INCLUDE"), os.environ.get("VOXMEND_LIB")
    if bool(include) != bool(lib):
        sys.exit("of VOXMEND_INCLUDE and VOXMEND_LIB one is set: set both or none")
    if include and lib:
        return [include], [lib]
    if build_library.is_packed():
        return [build_library.INCLUDE], [build_library.STAGED]
    try:
        flags = subprocess.run(
            ["pkg-config", "--cflags-only-I", "--libs-only-L", "--keep-system-cflags", "--keep-system-libs", "voxmend"],
            check=True, capture_output=True, text=True).stdout
    except (OSError, subprocess.CalledProcessError):
        sys.exit("voxmend is not found by pkg-config: install the library first ('make install'), set PKG_CONFIG_PATH to "
                 "the folder of voxmend.pc, or set VOXMEND_INCLUDE and VOXMEND_LIB to the folders of voxmend.h and "
                 "libvoxmend.so")
    words = shlex.split(flags)
    includes = [w[2:] for w in words if w.startswith("-I")] or ["/usr/include"]
    libs = [w[2:] for w in words if w.startswith("-L")]
    return includes, libs


def remembered(folders):
    """Folders for the extension's rpath: none, unless they are asked for."""
    wanted = os.environ.get("VOXMEND_RPATH", "")
    if wanted in ("", "0"):
        return []
    if wanted != "1":
        sys.exit("VOXMEND_RPATH is %r: set it to 1, or leave it out" % wanted)
    return [os.path.abspath(folder) for folder in folders]


def read_header(folders, name="voxmend.h", seen=None):
    """The text of a header with those of the library that it includes in their places, each once."""
    seen = set() if seen is None else seen
    seen.add(name)
    for folder in folders:
        path = os.path.join(folder, name)
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                return re.sub(r'^#include "(voxmend/\w+\.h)"$', lambda found: "" if found[1] in seen else
                              read_header(folders, found[1], seen), file.read(), flags=re.M)
    sys.exit("%s is in none of %s" % (name, ", ".join(folders)))


def declarations(header):
    """What cffi reads of a header: no comments, no preprocessor; numbers in place of their names."""
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    text = re.sub(r"^#ifdef __cplusplus$.*?^#endif$", "", text, flags=re.S | re.M)
    text = text.replace("\\\n", " ")
    numbers = dict(re.findall(r"^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]+(\d+)[ \t]*$", text, flags=re.M))
    text = re.sub(r"^[ \t]*#.*$", "", text, flags=re.M)
    text = text.replace("VXM_API", "")
    for name, number in numbers.items():
        text = re.sub(r"\b%s\b" % name, number, text)
    return text


def initializers(header):
    """The structs that have an initializer: a function fills each, as macros are out of reach."""
    found = re.findall(r"#define VXM_(\w+)_INIT\b", header)
    return ["vxm_" + name.lower() for name in found]


# How a call that takes long is ended, and what it tells meanwhile: the library asks now and then whether to go on. In a thread
# that has a flag to stop at, that is looked at, and so is its deadline; a thread that wants to know how far the work is gets a
# word now and then; in Python's main thread the interpreter is asked whether a handler of signals has raised something.
PROGRESS = r"""
#include <stdint.h>
#include <string.h>
#include <time.h>

static int voxmend_ask(void);
static int voxmend_tell(const char *phase, double fraction);

static _Thread_local int asks, tells, timed_out;
static _Thread_local const volatile int *stop_at;
static _Thread_local int64_t asked_ms, told_ms, deadline_ms; /* a deadline of 0 is none */
static _Thread_local char told_phase[64];

static int64_t voxmend_now_ms(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int64_t)time.tv_sec * 1000 + time.tv_nsec / 1000000;
}

static int voxmend_enter(int ask) {
  int before = asks;
  asks = ask;
  timed_out = 0;
  return before;
}

static void voxmend_leave(int before) {
  asks = before;
}

static int *voxmend_stop_at(int *flag) {
  int *before = (int *)stop_at;
  stop_at = flag;
  return before;
}

static int voxmend_tell_progress(int on) {
  int before = tells;
  tells = on;
  told_phase[0] = '\0';
  return before;
}

static int64_t voxmend_set_deadline(int64_t ms) {
  int64_t before = deadline_ms;
  deadline_ms = ms;
  return before;
}

static int voxmend_is_late(void) {
  return deadline_ms > 0 && voxmend_now_ms() >= deadline_ms;
}

static int voxmend_timed_out(void) {
  return timed_out;
}

static int voxmend_is_new_phase(const char *phase) {
  if (strncmp(phase, told_phase, sizeof told_phase - 1) == 0)
    return 0;
  strncpy(told_phase, phase, sizeof told_phase - 1);
  return 1;
}

static int voxmend_on_progress(const char *phase, double fraction, void *payload) {
  enum { ASK_MS = 20, TELL_MS = 50 /* each time costs a turn of the interpreter */ };
  (void)payload;
  if (stop_at && *stop_at)
    return 1;
  if (!asks && !tells && deadline_ms == 0)
    return 0;
  int64_t now = voxmend_now_ms();
  if (deadline_ms > 0 && now >= deadline_ms)
    return timed_out = 1;
  if (tells && (voxmend_is_new_phase(phase) || now - told_ms >= TELL_MS)) {
    told_ms = now;
    if (voxmend_tell(phase, fraction) != 0)
      return 1;
  }
  if (!asks || now - asked_ms < ASK_MS)
    return 0;
  asked_ms = now;
  return voxmend_ask();
}
"""

# Rows of bits, each of which begins with a byte of its own, the first in its lowest bit, become bytes or floats of 0 and 1.
# What a numpy array gives may lie anywhere, hence memcpy.
UNPACKING = r"""
#include <stddef.h>
#include <string.h>

static void voxmend_unpack_rows(void *out, const unsigned char *bits, int64_t rows, int64_t length, int as_floats) {
  unsigned char bytes[256][8];
  float floats[256][8];
  size_t n = (size_t)length, entry = as_floats ? sizeof floats[0] : sizeof bytes[0], each = entry / 8;
  const unsigned char *table = as_floats ? (const unsigned char *)floats : bytes[0];
  unsigned char *to = out;
  for (int value = 0; value < 256; value++)
    for (int bit = 0; bit < 8; bit++) {
      bytes[value][bit] = (unsigned char)(value >> bit & 1);
      floats[value][bit] = (float)(value >> bit & 1);
    }
  for (int64_t row = 0; row < rows; row++) {
    for (size_t b = 0; b < n / 8; b++, to += entry)
      memcpy(to, table + *bits++ * entry, entry);
    if (n % 8 > 0) {
      memcpy(to, table + *bits++ * entry, n % 8 * each);
      to += n % 8 * each;
    }
  }
}
"""

# What would be a call of Python for each defect, or for each voxel of an octree.
GATHERING = r"""
static void voxmend_defects_gather(const vxm_defects *defects, int32_t *kinds, int64_t *elements, double *positions) {
  int64_t count = vxm_defects_count(defects);
  for (int64_t i = 0; i < count; i++) {
    const vxm_defect *one = vxm_defects_item(defects, i);
    kinds[i] = (int32_t)one->kind;
    memcpy(elements + 2 * i, one->element, sizeof one->element);
    memcpy(positions + 6 * i, one->position, sizeof one->position);
  }
}

static void voxmend_sparse_look_up(const vxm_sparse *sparse, const int64_t *indices, int64_t count, uint8_t *filled) {
  for (int64_t n = 0; n < count; n++)
    filled[n] = vxm_sparse_get(sparse, indices[3 * n], indices[3 * n + 1], indices[3 * n + 2]);
}

typedef struct voxmend_box {
  const int64_t *begin, *end; /* voxels that are wanted, from the first to the one after the last */
  uint8_t *bytes;             /* a byte for each of them, z fastest, or NULL */
  int64_t *indices;           /* or where the next index goes */
} voxmend_box;

static void voxmend_take_piece(const vxm_sparse_piece *piece, void *payload) {
  voxmend_box *box = payload;
  int64_t from[3], to[3];
  for (int a = 0; a < 3; a++) {
    from[a] = piece->position[a] > box->begin[a] ? piece->position[a] : box->begin[a];
    to[a] = piece->position[a] + piece->side < box->end[a] ? piece->position[a] + piece->side : box->end[a];
    if (from[a] >= to[a])
      return;
  }
  int is_cube = piece->bits == ~UINT64_C(0);
  int64_t rows = box->end[1] - box->begin[1], length = box->end[2] - box->begin[2];
  for (int64_t i = from[0]; i < to[0]; i++)
    for (int64_t j = from[1]; j < to[1]; j++) {
      uint8_t *row = box->bytes ? box->bytes + ((i - box->begin[0]) * rows + (j - box->begin[1])) * length : NULL;
      for (int64_t k = from[2]; k < to[2]; k++) {
        if (!is_cube && !(piece->bits >> ((k & 3) * 16 + (j & 3) * 4 + (i & 3)) & 1))
          continue;
        if (row) {
          row[k - box->begin[2]] = 1;
        } else {
          box->indices[0] = i, box->indices[1] = j, box->indices[2] = k;
          box->indices += 3;
        }
      }
    }
}

static void voxmend_sparse_window(const vxm_sparse *sparse, const int64_t *begin, const int64_t *end, uint8_t *bytes) {
  voxmend_box box = {begin, end, bytes, NULL};
  vxm_sparse_visit(sparse, voxmend_take_piece, &box);
}

static void voxmend_sparse_indices(const vxm_sparse *sparse, int64_t *indices) {
  static const int64_t begin[3] = {0, 0, 0};
  voxmend_box box = {begin, vxm_sparse_space(sparse)->dims, NULL, indices};
  vxm_sparse_visit(sparse, voxmend_take_piece, &box);
}
"""
DECLARED = """
void voxmend_defects_gather(const vxm_defects *defects, int32_t *kinds, int64_t *elements, double *positions);
void voxmend_sparse_look_up(const vxm_sparse *sparse, const int64_t *indices, int64_t count, uint8_t *filled);
void voxmend_sparse_window(const vxm_sparse *sparse, const int64_t *begin, const int64_t *end, uint8_t *bytes);
void voxmend_sparse_indices(const vxm_sparse *sparse, int64_t *indices);
void voxmend_unpack_rows(void *out, const unsigned char *bits, int64_t rows, int64_t length, int as_floats);
extern "Python" int voxmend_ask(void);
extern "Python" int voxmend_tell(const char *phase, double fraction);
int64_t voxmend_now_ms(void);
int voxmend_tell_progress(int on);
int64_t voxmend_set_deadline(int64_t ms);
int voxmend_is_late(void);
int voxmend_timed_out(void);
int voxmend_enter(int ask);
void voxmend_leave(int before);
int *voxmend_stop_at(int *flag);
int voxmend_on_progress(const char *phase, double fraction, void *payload);
"""

# Not the tag that LD_LIBRARY_PATH goes before.
OWN = ["-Wl,--disable-new-dtags,-rpath,$ORIGIN/lib"] if build_library.is_packed() else []

include_dirs, library_dirs = find_library()
HEADER = read_header(include_dirs)
NAMES = initializers(HEADER)

ffi = FFI()
ffi.cdef(declarations(HEADER) + "".join("void voxmend_init_%s(%s *out);\n" % (n, n) for n in NAMES) + DECLARED)
ffi.set_source(
    "voxmend._voxmend",
    '#include "voxmend.h"\n' + "".join(
        "static void voxmend_init_%s(%s *out) { %s value = %s_INIT; *out = value; }\n" % (n, n, n, n.upper())
        for n in NAMES) + PROGRESS + UNPACKING + GATHERING,
    include_dirs=include_dirs, library_dirs=library_dirs, runtime_library_dirs=remembered(library_dirs), libraries=["voxmend"],
    extra_link_args=OWN)

if __name__ == "__main__":
    ffi.compile(verbose=False, tmpdir=sys.argv[1] if len(sys.argv) > 1 else ".")
