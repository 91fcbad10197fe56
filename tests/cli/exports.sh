#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shared library shows exactly the functions of voxmend.h, which compiles alone as strict C99 and as C++; a module
# shows its table alone.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-exports.XXXXXX")
trap 'rm -rf "$work"' EXIT
header=$SRCDIR/src/voxmend.h

library=$BUILDDIR/.libs/libvoxmend.so
[ -e "$library" ] || { echo "no shared library in this build"; exit 77; }
# Sanitizers add symbols of their own.
exported_by() {
  nm -D --defined-only "$1" | awk '{ print $3 }' | grep -vE '^(__odr_asan|__asan|__ubsan|_init$|_fini$)' | sort -u
}
exported_by "$library" >"$work/exported"
tr '\n' ' ' <"$header" | grep -oE 'VXM_API [^;(]*\(' | grep -oE 'vxm_[a-z0-9_]+\(' | tr -d '(' | sort -u >"$work/declared"
[ -s "$work/declared" ]
diff "$work/declared" "$work/exported" || { echo "FAILED: declared (<) and exported (>) differ"; exit 1; }

for module in "$BUILDDIR"/.libs/voxmend-*.so; do
  [ -e "$module" ] || continue
  [ "$(exported_by "$module")" = vxm_module_table ] || {
    echo "FAILED: $module shows more than its table:"
    exported_by "$module" | head
    exit 1
  }
done

printf '#include "voxmend.h"\nint main(void) { vxm_error e = VXM_ERROR_INIT; return (int)e.code; }\n' >"$work/alone.c"
cp "$work/alone.c" "$work/alone.cc"
${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$SRCDIR/src" "$work/alone.c"
for compiler in g++ clang++; do
  command -v "$compiler" >/dev/null || continue
  "$compiler" -std=c++11 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$SRCDIR/src" "$work/alone.cc"
done
