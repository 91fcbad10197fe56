#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shared library shows exactly the functions of voxmend.h, which compiles alone as strict C99 and as C++.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-exports.XXXXXX")
trap 'rm -rf "$work"' EXIT
header=$SRCDIR/src/voxmend.h

library=$BUILDDIR/.libs/libvoxmend.so
[ -e "$library" ] || { echo "no shared library in this build"; exit 77; }
# Sanitizers add symbols of their own.
nm -D --defined-only "$library" | awk '{ print $3 }' | grep -vE '^(__odr_asan|__asan|__ubsan|_init$|_fini$)' |
  sort -u >"$work/exported"
tr '\n' ' ' <"$header" | grep -oE 'VXM_API [^;(]*\(' | grep -oE 'vxm_[a-z0-9_]+\(' | tr -d '(' | sort -u >"$work/declared"
[ -s "$work/declared" ]
diff "$work/declared" "$work/exported" || { echo "FAILED: declared (<) and exported (>) differ"; exit 1; }

printf '#include "voxmend.h"\nint main(void) { vxm_error e = VXM_ERROR_INIT; return (int)e.code; }\n' >"$work/alone.c"
cp "$work/alone.c" "$work/alone.cc"
${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$SRCDIR/src" "$work/alone.c"
for compiler in g++ clang++; do
  command -v "$compiler" >/dev/null || continue
  "$compiler" -std=c++11 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$SRCDIR/src" "$work/alone.cc"
done
