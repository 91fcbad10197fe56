#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The OpenCL kernels compile for the GPUs of several vendors, whole: clang has their targets, so that this needs no device.
# Skipped where clang has none of them.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-kernels.XXXXXX")
trap 'rm -rf "$work"' EXIT
bad=0
done=0
echo '__kernel void nothing(void) {}' >"$work/nothing.cl"
for target in amdgcn-amd-amdhsa:gfx906 amdgcn-amd-amdhsa:gfx1030 nvptx64-nvidia-nvcl:; do
  triple=${target%%:*}
  cpu=${target#*:}
  form=-c
  case $triple in
  nvptx64*) form=-S ;; # there is no assembler for it, and so nothing to look through
  esac
  compile_this() {
    clang -x cl -cl-std=CL1.2 -Xclang -finclude-default-header -Wall -Wno-unused-function -DGROUP=64 -O2 -target "$triple" \
      ${cpu:+-mcpu=$cpu} -nogpulib $form -o "$2" "$1"
  }
  compile_this "$work/nothing.cl" "$work/nothing.o" >"$work/why.txt" 2>&1 || continue
  sed -n '/^static const char \*const sources/,/^};/p' "$SRCDIR/src/gpu/opencl/cl_program.c" |
    tr '\n' ' ' | sed 's/},/}\n/g' | sed -n -E 's/.*\[(VXM_CL_[A-Z_]*)\] = \{(.*)\}$/\1 \2/p' | tr -d '",' >"$work/programs.txt"
  test "$(wc -l <"$work/programs.txt")" -eq 11
  while read -r program files; do
    (cd "$SRCDIR/shaders" && cat $files) >"$work/program.cl"
    if ! compile_this "$work/program.cl" "$work/program.o" >"$work/out.txt" 2>&1; then
      echo "$program does not compile for $triple $cpu:"
      cat "$work/out.txt"
      bad=1
      continue
    fi
    cat "$work/out.txt"
    missing=
    if [ $form = -c ]; then
      missing=$(readelf -sW "$work/program.o" | awk '$7 == "UND" && $8 != "" { print $8 }' | grep -v '^_Z' || true)
    fi
    if [ -n "$missing" ]; then
      echo "$program for $triple $cpu lacks $missing"
      bad=1
    fi
    done=$((done + 1))
  done <"$work/programs.txt"
done
if [ "$done" -eq 0 ] && [ "$bad" -eq 0 ]; then
  echo "clang does not compile for GPUs here"
  exit 77
fi
echo "$done programs compiled"
exit "$bad"
