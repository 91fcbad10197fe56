# SPDX-License-Identifier: BSD-3-Clause
"""Makes the binding voxmend._voxmend from voxmend.h itself, so that the two cannot differ.

The library is found by pkg-config. VOXMEND_INCLUDE and VOXMEND_LIB, the folders of voxmend.h and of libvoxmend.so, take
precedence: for a library that was built and not installed.
"""
import os
import re
import shlex
import subprocess
import sys

from cffi import FFI


def find_library():
    """Folders of headers and libraries, and those to remember for when the program runs."""
    include, lib = os.environ.get("VOXMEND_INCLUDE"), os.environ.get("VOXMEND_LIB")
    if include and lib:
        return [include], [lib], [lib]
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
    return includes, libs, [d for d in libs if not d.startswith("/usr/lib")]


def read_header(folders):
    for folder in folders:
        path = os.path.join(folder, "voxmend.h")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                return file.read()
    sys.exit("voxmend.h is in none of " + ", ".join(folders))


def declarations(header):
    """What cffi reads of a header: no comments, no preprocessor; numbers in place of their names."""
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    text = text.replace("\\\n", " ")
    numbers = dict(re.findall(r"^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]+(\d+)[ \t]*$", text, flags=re.M))
    text = re.sub(r"^[ \t]*#.*$", "", text, flags=re.M)
    text = re.sub(r'extern "C" \{', "", text)
    text = text.replace("VXM_API", "")
    for name, number in numbers.items():
        text = re.sub(r"\b%s\b" % name, number, text)
    end = text.rstrip()
    if end.endswith("}"):  # of extern "C"
        end = end[:-1]
    return end


def initializers(header):
    """The structs that have an initializer: a function fills each, as macros are out of reach."""
    found = re.findall(r"#define VXM_(\w+)_INIT\b", header)
    return ["vxm_" + name.lower() for name in found]


include_dirs, library_dirs, runtime_dirs = find_library()
HEADER = read_header(include_dirs)
NAMES = initializers(HEADER)

ffi = FFI()
ffi.cdef(declarations(HEADER) + "".join("void voxmend_init_%s(%s *out);\n" % (n, n) for n in NAMES))
ffi.set_source(
    "voxmend._voxmend",
    '#include "voxmend.h"\n' + "".join(
        "static void voxmend_init_%s(%s *out) { %s value = %s_INIT; *out = value; }\n" % (n, n, n, n.upper())
        for n in NAMES),
    include_dirs=include_dirs, library_dirs=library_dirs, runtime_library_dirs=runtime_dirs, libraries=["voxmend"])

if __name__ == "__main__":
    ffi.compile(verbose=False, tmpdir=sys.argv[1] if len(sys.argv) > 1 else ".")
