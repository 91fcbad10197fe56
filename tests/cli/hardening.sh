#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What is built has the hardening that configure promised: programs, the library, modules and the Python extension.
set -eu
command -v readelf >/dev/null || { echo "no readelf here"; exit 77; }
flags=$(sed -n 's/^#define VXM_HARDENED_BY "\(.*\)"$/\1/p' "$BUILDDIR/config.h")
case $flags in
no*) echo "this build has no hardening ($flags)"; exit 77 ;;
esac
failed=0

has() {
  case " $flags " in
  *" $1 "*) ;;
  *) false ;;
  esac
}

# lacks FILE WHAT: reports a failure.
lacks() {
  echo "FAILED: $1: $2"
  failed=1
}

check() {
  readelf -hldW --dyn-syms "$1" >"$work"
  ! has -Wl,-z,relro || grep -q GNU_RELRO "$work" || lacks "$1" "relocations stay writable"
  ! has -Wl,-z,now || grep -qE 'BIND_NOW|Flags:.* NOW' "$work" || lacks "$1" "symbols are bound lazily"
  ! has -Wl,-z,noexecstack || grep -qE 'GNU_STACK.* RW  *0x' "$work" || lacks "$1" "the stack is executable"
  ! has -fstack-protector-strong || grep -q __stack_chk_fail "$work" || lacks "$1" "no stack protector"
}

work=$(mktemp "${TMPDIR:-/tmp}/voxmend-hardening.XXXXXX")
trap 'rm -f "$work"' EXIT
checked=0
for name in voxmend binvox voxmend-reader libvoxmend.so voxmend-assimp.so voxmend-cgal.so voxmend-occt.so voxmend-openmesh.so \
  voxmend-openvdb.so; do
  file=$BUILDDIR/.libs/$name
  [ -e "$file" ] || file=$BUILDDIR/$name
  readelf -h "$file" >/dev/null 2>&1 || continue
  check "$file"
  checked=$((checked + 1))
  case $name in
  libvoxmend.so)
    ! echo "$flags" | grep -q FORTIFY_SOURCE || grep -qE '__[a-z]+_chk' "$work" || lacks "$file" "no checked functions"
    ;;
  voxmend | voxmend-reader)
    ! has -pie || grep -q 'FLAGS_1.* PIE' "$work" || lacks "$file" "not position-independent"
    ;;
  esac
done
for file in "$BUILDDIR"/python-package/voxmend/_voxmend*.so; do
  [ ! -e "$file" ] || check "$file"
done
[ "$checked" -ge 2 ] || { echo "FAILED: nothing was found to check in $BUILDDIR"; exit 1; }
exit "$failed"
