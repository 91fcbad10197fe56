#!/bin/bash -eu
# SPDX-License-Identifier: BSD-3-Clause
# What OSS-Fuzz and ClusterFuzzLite run to build the targets: into $OUT go a program, a dictionary and the seeds for each
# target that needs no module. CC, CXX, CFLAGS, CXXFLAGS and LIB_FUZZING_ENGINE are theirs; without them, those of README.md.
source=$(cd "$(dirname "$0")/../.." && pwd)
out=${OUT:?the folder for the targets}
: "${CC:=clang}" "${CXX:=clang++}" "${LIB_FUZZING_ENGINE:=-fsanitize=fuzzer}"
: "${CFLAGS:=-O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined}" "${CXXFLAGS:=$CFLAGS}"
export CC CXX CFLAGS CXXFLAGS LIB_FUZZING_ENGINE

cd "$source"
[ -e configure ] || autoreconf -i
mkdir -p "${WORK:-$source/build-fuzz}"
cd "${WORK:-$source/build-fuzz}"
"$source/configure" -q --enable-fuzzers --disable-shared --without-openvdb --without-cgal --without-assimp --without-occt \
  --without-openmesh --without-python --without-opengl --without-opencl --without-cmocka
make -j"$(nproc)" V=0

mkdir -p "$out"
for dictionary in "$source"/tests/fuzz/*.dict; do
  target=$(basename "$dictionary" .dict)
  grep -qE "\"$target\", fuzz_[a-z]+, [a-z]+, NULL" "$source/tests/fuzz/targets.c" || continue
  cp tests/fuzz/fuzz "$out/fuzz_$target"
  cp "$dictionary" "$out/fuzz_$target.dict"
  (cd "$source/tests/fuzz/corpus/$target" && python3 -m zipfile -c "$out/fuzz_${target}_seed_corpus.zip" ./*)
done
