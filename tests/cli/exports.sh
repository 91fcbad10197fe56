#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The shared library shows exactly the functions of the public headers, each under its version of symbols. Each header
# compiles alone as strict C99 and as C++; every struct in them begins with its size, but for two values; what
# voxmend.h includes is all but what is experimental. A module shows its table alone.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-exports.XXXXXX")
trap 'rm -rf "$work"' EXIT
headers=$SRCDIR/src/voxmend

fail() {
  echo "FAILED: $1"
  exit 1
}

library=$BUILDDIR/.libs/libvoxmend.so
[ -e "$library" ] || { echo "no shared library in this build"; exit 77; }
# Sanitizers add symbols of their own.
exported_by() {
  nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }' | grep -vE '^(__odr_asan|__asan|__ubsan|_init(@|$)|_fini(@|$))' | sort -u
}
# name@@VERSION of each function that a header declares.
declared_in() {
  tr '\n' ' ' <"$1" | grep -oE 'VXM_API [^;(]*\(' | grep -oE 'vxm_[a-z0-9_]+\(' | sed "s/($/@@$2/"
}
exported_by "$library" >"$work/exported"
for header in "$headers"/*.h; do
  case $header in
  */experimental.h) declared_in "$header" VOXMEND_EXPERIMENTAL ;;
  *) declared_in "$header" VOXMEND_1 ;;
  esac
done | sort -u >"$work/declared"
[ -s "$work/declared" ]
diff "$work/declared" "$work/exported" || fail "declared (<) and exported (>) differ: src/api/voxmend.map lists the functions"

sed -n 's/^ \(vxm_.*\)@\(VOXMEND_.*\) .*/\1@@\2/p' "$SRCDIR"/packaging/debian/libvoxmend*.symbols | sort >"$work/packaged"
diff "$work/packaged" "$work/exported" || fail "packaging/debian/libvoxmend*.symbols (<) and exported (>) differ"

for module in "$BUILDDIR"/.libs/voxmend-*.so; do
  [ -e "$module" ] || continue
  [ "$(exported_by "$module")" = vxm_module_table ] || {
    exported_by "$module" | head
    fail "$module shows more than its table"
  }
done

# ---- The headers ----

listed=$(sed -n 's|^#include "voxmend/\(.*\)"$|\1|p' "$SRCDIR/src/voxmend.h" | sort | tr '\n' ' ')
there=$(cd "$headers" && ls | grep -v '^experimental\.h$' | sort | tr '\n' ' ')
[ "$listed" = "$there" ] || fail "voxmend.h includes $listed, not $there"

unsized=$(cat "$headers"/*.h | awk '/^typedef struct vxm_[a-z_]+ \{/ { name = $3; getline; if ($0 !~ /^  size_t size;/) print name }' | sort | tr '\n' ' ')
[ "$unsized" = "vxm_space vxm_variant " ] || fail "structs without their size: $unsized"

for header in voxmend.h voxmend/base.h voxmend/carve.h voxmend/engine.h voxmend/experimental.h voxmend/field.h voxmend/grid.h voxmend/mesh.h \
  voxmend/repair.h voxmend/sampler.h voxmend/sparse.h voxmend/voxelize.h; do
  [ -e "$SRCDIR/src/$header" ] || fail "there is no $header"
  # every initializer of the header, too
  {
    printf '#include "%s"\nint main(void) {\n' "$header"
    sed -n 's/^#define VXM_\([A-Z_]*\)_INIT.*/\1/p' "$SRCDIR/src/$header" | while read -r name; do
      lower=$(echo "$name" | tr '[:upper:]' '[:lower:]')
      printf '  { vxm_%s made = VXM_%s_INIT; if (made.size != sizeof made) return 1; }\n' "$lower" "$name"
    done
    printf '  return 0;\n}\n'
  } >"$work/alone.c"
  cp "$work/alone.c" "$work/alone.cc"
  ${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -I "$SRCDIR/src" -o "$work/alone" "$work/alone.c"
  "$work/alone" || fail "an initializer of $header does not set its size"
  for compiler in g++ clang++; do
    command -v "$compiler" >/dev/null || continue
    "$compiler" -std=c++11 -pedantic -Wall -Wextra -Werror -fsyntax-only -I "$SRCDIR/src" "$work/alone.cc"
  done
done
