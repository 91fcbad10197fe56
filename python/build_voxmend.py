# SPDX-License-Identifier: BSD-3-Clause
"""Makes the binding voxmend._voxmend from voxmend.h and what it includes, so that the two cannot differ.

The library is found by pkg-config. VOXMEND_INCLUDE and VOXMEND_LIB, the folders of voxmend.h and of libvoxmend.so, take
precedence: for a library that was built and not installed. When the package runs, the system finds the library as any other
(ldconfig, LD_LIBRARY_PATH); VOXMEND_RPATH=1 has the extension remember the folder in which it was found.
"""
import os
import re
import shlex
import subprocess
import sys

from cffi import FFI


def find_library():
    """Folders of headers and libraries."""
    include, lib = os.environ.get("VOXMEND_INCLUDE"), os.environ.get("VOXMEND_LIB")
    if bool(include) != bool(lib):
        sys.exit("of VOXMEND_INCLUDE and VOXMEND_LIB one is set: set both or none")
    if include and lib:
        return [include], [lib]
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


# How a call that takes long is ended: the library asks now and then whether to go on. In a thread that has a flag to stop at,
# that is looked at; in Python's main thread the interpreter, now and then, whether a handler of signals has raised something.
PROGRESS = r"""
#include <stdint.h>
#include <time.h>

static int voxmend_ask(void);

static _Thread_local int asks;
static _Thread_local const volatile int *stop_at;
static _Thread_local int64_t asked_ms;

static int voxmend_enter(int ask) {
  int before = asks;
  asks = ask;
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

static int voxmend_on_progress(const char *phase, double fraction, void *payload) {
  enum { ASK_MS = 50 /* each time costs a turn of the interpreter */ };
  struct timespec time;
  (void)phase;
  (void)fraction;
  (void)payload;
  if (stop_at && *stop_at)
    return 1;
  if (!asks)
    return 0;
  clock_gettime(CLOCK_MONOTONIC, &time);
  int64_t now = (int64_t)time.tv_sec * 1000 + time.tv_nsec / 1000000;
  if (now - asked_ms < ASK_MS)
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
DECLARED = """
void voxmend_unpack_rows(void *out, const unsigned char *bits, int64_t rows, int64_t length, int as_floats);
extern "Python" int voxmend_ask(void);
int voxmend_enter(int ask);
void voxmend_leave(int before);
int *voxmend_stop_at(int *flag);
int voxmend_on_progress(const char *phase, double fraction, void *payload);
"""

include_dirs, library_dirs = find_library()
HEADER = read_header(include_dirs)
NAMES = initializers(HEADER)

ffi = FFI()
ffi.cdef(declarations(HEADER) + "".join("void voxmend_init_%s(%s *out);\n" % (n, n) for n in NAMES) + DECLARED)
ffi.set_source(
    "voxmend._voxmend",
    '#include "voxmend.h"\n' + "".join(
        "static void voxmend_init_%s(%s *out) { %s value = %s_INIT; *out = value; }\n" % (n, n, n, n.upper())
        for n in NAMES) + PROGRESS + UNPACKING,
    include_dirs=include_dirs, library_dirs=library_dirs, runtime_library_dirs=remembered(library_dirs), libraries=["voxmend"])

if __name__ == "__main__":
    ffi.compile(verbose=False, tmpdir=sys.argv[1] if len(sys.argv) > 1 else ".")
