#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Programs outside of this build find the installed library by pkg-config, CMake and Meson, the shared one and (where it was
# built) the static one, in C and C++17, also where the installed tree was moved; the Python sample does what that in C++
# does. Skipped where CMake or Meson is missing, after all that needs neither.
set -eu
unset MAKEFLAGS MFLAGS MAKELEVEL VOXMEND_MODULES
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-linking.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*"
  exit 1
}
[ -e "$BUILDDIR/.libs/libvoxmend.so" ] || { echo "no shared library in this build"; exit 77; }
case $(sed -n 's/^VXM_CFLAGS = //p' "$BUILDDIR/Makefile") in
*-fsanitize=*) echo "programs would need the sanitizers of the library"; exit 77 ;;
esac
pkg_config=$(sed -n 's/^PKG_CONFIG = //p' "$BUILDDIR/Makefile")
c="${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Werror"
cxx="${CXX:-c++} -std=c++17 -Wall -Wextra -Wpedantic -Werror"

# What a package for developers has, and no more.
make -s -C "$BUILDDIR" DESTDIR="$work/stage" install-libLTLIBRARIES install-includeHEADERS install-voxmendHEADERS \
  install-pkgconfigDATA install-cmakeDATA >"$work/log" 2>&1 || { cat "$work/log"; fail "make install"; }
libdir=$(dirname "$(find "$work/stage" -name 'libvoxmend.so')")
prefix=$(dirname "$(dirname "$(find "$work/stage" -name voxmend.h)")")
export PKG_CONFIG_PATH="$libdir/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$work/stage"

# Two parts: a block, and a box without a lid.
box() { # NAME X FIRST [LID]
  for corner in "0 0 0" "1 0 0" "1 1 0" "0 1 0" "0 0 1" "1 0 1" "1 1 1" "0 1 1"; do
    set -- "$1" "$2" "$3" "$4" $corner
    echo "v $(($2 + $5)) $6 $7"
  done
  echo "g $1"
  for face in "4 3 2 1" "1 2 6 5" "2 3 7 6" "3 4 8 7" "4 1 5 8" $4; do
    set -- "$1" "$2" "$3" "$4" $face
    echo "f $(($3 + $5)) $(($3 + $6)) $(($3 + $7)) $(($3 + $8))"
  done
}
{
  box block 0 0 ""
  echo "f 5 6 7 8"
  box tray 3 8 ""
} >"$work/two.obj"

# runs FOLDER [LIBRARY-PATH]: the samples in it do their work.
runs() {
  LD_LIBRARY_PATH=${2:-} "$1/voxelize_file" "$SRCDIR/samples/rocket.off" "$work/rocket.npy" 32 >"$work/out" || fail "$1/voxelize_file"
  grep -Eq '^[1-9][0-9]* voxels$' "$work/out" || fail "$1/voxelize_file: $(cat "$work/out")"
  [ -x "$1/import_parts" ] || return 0
  LD_LIBRARY_PATH=${2:-} "$1/import_parts" "$work/two.obj" --resolution 32 >"$work/parts" || fail "$1/import_parts"
  printf '%s: %d faces, closed, volume 1, moved 0, 512 voxels\n' block 6 tray 5 | diff - "$work/parts" || fail "$1/import_parts"
}

# ---- pkg-config ----

mkdir "$work/plain" "$work/static"
version=$($pkg_config --modversion voxmend)
[ "$version" = "$("$VOXMEND" --version | sed -n '1s/^voxmend \([^ ]*\).*/\1/p')" ] || fail "voxmend.pc is of version $version"
$c "$SRCDIR/samples/voxelize_file.c" -o "$work/plain/voxelize_file" $($pkg_config --cflags --libs voxmend)
$cxx "$SRCDIR/samples/import_parts.cc" -o "$work/plain/import_parts" $($pkg_config --cflags --libs voxmend)
runs "$work/plain" "$libdir"
code=0
LD_LIBRARY_PATH=$libdir "$work/plain/import_parts" "$work/two.obj" --seconds 0 >"$work/out" 2>&1 || code=$?
[ "$code" -eq 3 ] && grep -q '^import_parts: time is up while ' "$work/out" || fail "import_parts does not cancel: $(cat "$work/out")"

if [ -e "$libdir/libvoxmend.a" ]; then
  mkdir "$work/archive"
  cp "$libdir/libvoxmend.a" "$work/archive/"
  $c "$SRCDIR/samples/voxelize_file.c" -o "$work/static/voxelize_file" $($pkg_config --cflags voxmend) -L"$work/archive" \
    $($pkg_config --static --libs voxmend | sed 's/-lvoxmend/-l:libvoxmend.a/')
  runs "$work/static"
fi

# ---- The same in Python ----

if [ -d "$BUILDDIR/python-package" ]; then
  PYTHONPATH=$BUILDDIR/python-package LD_LIBRARY_PATH=$libdir "$TEST_PYTHON" "$SRCDIR/samples/import_parts.py" "$work/two.obj" \
    --resolution 32 >"$work/out" || fail "import_parts.py"
  diff "$work/parts" "$work/out" || fail "import_parts in C++ (<) and in Python (>) differ"
fi

# ---- CMake and Meson; the tree was moved ----

missing=
by_cmake() { # FOLDER BUILD-FOLDER: configures, and tells in the log
  env -u PKG_CONFIG_PATH -u PKG_CONFIG_SYSROOT_DIR cmake -S "$1" -B "$2" -DCMAKE_PREFIX_PATH="$work/moved" >"$work/log" 2>&1
}
if command -v cmake >/dev/null; then
  mv "$prefix" "$work/moved"
  by_cmake "$SRCDIR/samples" "$work/cmake" && cmake --build "$work/cmake" >>"$work/log" 2>&1 ||
    { cat "$work/log"; fail "CMake"; }
  runs "$work/cmake"
  for asked in 99 1.99 0.1; do
    sed "s/voxmend 1.0 REQUIRED/voxmend $asked REQUIRED/" "$SRCDIR/samples/CMakeLists.txt" >"$work/CMakeLists.txt"
    if by_cmake "$work" "$work/other"; then
      fail "CMake takes this version for $asked"
    fi
    grep -q 'compatible with' "$work/log" || { cat "$work/log"; fail "CMake fails otherwise"; }
  done
  if [ -d "$work/archive" ]; then
    sed 's/voxmend::voxmend/voxmend::static/' "$SRCDIR/samples/CMakeLists.txt" >"$work/CMakeLists.txt"
    cp "$SRCDIR"/samples/*.c "$SRCDIR"/samples/*.cc "$work/"
    by_cmake "$work" "$work/linked" && cmake --build "$work/linked" >>"$work/log" 2>&1 ||
      { cat "$work/log"; fail "CMake with the static library"; }
    runs "$work/linked"
  fi
  mv "$work/moved" "$prefix"
else
  missing="$missing cmake"
fi
if command -v meson >/dev/null; then
  meson setup "$work/meson" "$SRCDIR/samples" --werror >"$work/log" 2>&1 && ninja -C "$work/meson" >>"$work/log" 2>&1 ||
    { cat "$work/log"; fail "Meson"; }
  runs "$work/meson" "$libdir"
else
  missing="$missing meson"
fi
[ -z "$missing" ] || { echo "not tried, as they are not installed:$missing"; exit 77; }
