# SPDX-License-Identifier: BSD-3-Clause
"""Builds the library into the package: for an archive of PyPI, which has its sources in the folder library/.

VOXMEND_CONFIGURE has more options of configure, such as "--without-assimp". VOXMEND_INCLUDE and VOXMEND_LIB (build_voxmend.py)
name a library that is there, which is then used and not packed. VOXMEND_BUILD, the folder of a build, has that packed as it
is, without a compiler: for tests.

What is packed, in voxmend/: lib/libvoxmend.so.1, lib/voxmend/ with the modules and the process that reads by them, and bin/
with the programs. scripts/ has what starts these from the PATH.
"""
import os
import shlex
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCES = os.path.join(HERE, "library")
GIVEN = os.environ.get("VOXMEND_BUILD", "")
BUILD = os.path.abspath(GIVEN) if GIVEN else os.path.join(HERE, "build", "library")
STAGE = os.path.join(HERE, "build", "stage")
STAGED = os.path.join(STAGE, "lib")
# The programs that start from the PATH.
PROGRAMS = ["scripts/voxmend", "scripts/binvox"]


def find_sources():
    """The folder with configure and src/."""
    if not GIVEN:
        return SOURCES
    with open(os.path.join(BUILD, "Makefile"), encoding="utf-8") as file:
        return next(line.split(" = ")[1].strip() for line in file if line.startswith("abs_srcdir = "))


def is_packed():
    """Whether the package brings the library."""
    if os.environ.get("VOXMEND_LIB"):
        return False
    return bool(GIVEN) or os.path.exists(os.path.join(SOURCES, "configure"))


INCLUDE = os.path.join(find_sources(), "src")


def _run(words, folder):
    print("voxmend:", " ".join(words), flush=True)
    if subprocess.run(words, cwd=folder).returncode != 0:
        sys.exit("voxmend: the library could not be built, for what is said above. It needs compilers for C17 and C++17, make, "
                 "pkg-config, jansson and nettle (Debian: build-essential pkg-config libjansson-dev nettle-dev); more libraries "
                 "make more formats (README.md)")


def _configure():
    """CGAL is under the GPL, so that nobody gets it who has not asked for it."""
    os.makedirs(BUILD, exist_ok=True)
    if not os.path.exists(os.path.join(BUILD, "config.status")):
        _run([os.path.join(SOURCES, "configure"), "--quiet", "--prefix=/usr", "--enable-wheel", "--disable-maintainer-mode",
              "--disable-dependency-tracking", "--disable-static", "--without-python", "--without-cmocka", "--without-cgal",
              *shlex.split(os.environ.get("VOXMEND_CONFIGURE", ""))], BUILD)


def build():
    """Leaves the library, staged, where the extension is linked with it."""
    shutil.rmtree(STAGE, ignore_errors=True)
    os.environ.setdefault("CFLAGS", "-O2")
    os.environ.setdefault("CXXFLAGS", "-O2")
    if not GIVEN:
        _configure()
        _run(["make", "--silent", "-j%d" % len(os.sched_getaffinity(0))], BUILD)
    _run(["make", "--silent", "stage-wheel", "WHEEL_STAGE=" + STAGE], BUILD)


def place(package):
    """Puts it into the package's folder."""
    for folder in ("bin", "lib"):
        target = os.path.join(package, folder)
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(os.path.join(STAGE, folder), target, ignore=shutil.ignore_patterns("libvoxmend.so"))


def manual():
    """The manual page, by its name in the archive."""
    return os.path.relpath(os.path.join(find_sources(), "doc", "voxmend.1"), HERE)
