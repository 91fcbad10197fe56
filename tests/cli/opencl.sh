#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend voxelize --engine opencl on the first device that this machine has: the bits of the CPU; the cache of compiled
# programs. Skipped without a device.
. "$SRCDIR/tests/cli/lib.sh"
without_leak_check
if ! voxmend voxelize in/cube.off -o c.npy -r 8 -q --engine opencl 2>why.txt; then
  cat why.txt
  exit 77
fi

# same OPTION...: whether both methods make the file that the CPU makes.
same() {
  voxmend voxelize "$@" -o cpu.npy -q
  for method in triangles tiles; do
    voxmend voxelize "$@" -o cl.npy -q --engine opencl --cl-method $method
    cmp cpu.npy cl.npy
  done
}
# Bits of all kinds of grids are held by tests/gpu; here, that each option reaches the engine.
run 'same in/cube.off -r 64'
run 'same in/missing.off -r 48 --vote all --parts group'
run 'same in/rocket.off -r 300 --memlimit 64M'
once() {
  voxmend voxelize "$@" -o cpu.npy -q
  voxmend voxelize "$@" -o cl.npy -q --engine opencl
  cmp cpu.npy cl.npy
}
run 'once in/rocket.off -r 50x40x90 --mode both --surface thin'
run 'once in/rocket.off -r 64 --mode surface --surface shell18'
run 'once in/rocket.off -r 41x30x20 --coverage 8'
run 'once in/missing.off -r 40 --method winding'
run 'once in/rocket.off -r 40 --method tetra'
run 'voxmend voxelize in/rocket.off -o cpu.npy -r 100 -q; voxmend voxelize in/rocket.off -o a.rle -r 100 --sparse --engine opencl -q'
run 'voxmend convert a.rle -o b.npy -q && voxmend compare cpu.npy b.npy | grep only'
run 'voxmend voxelize in/rocket.off -o a.npy -r 64 --engine opencl | sed -E "s/opencl:[0-9]+ on .*/opencl:N on DEVICE/"'
run 'voxmend voxelize in/rocket.off -o a.npy -r 64 --engine opencl --memlimit 100K'
run 'ls a.npy.tmp* 2>/dev/null; cmp cpu.npy a.npy >/dev/null; test $? -eq 1'

say "# devices"
run 'voxmend engines --json | grep -A 15 "\"name\": \"opencl:0\"" | grep -cE "compute_units|clock_mhz|local_bytes|global_bytes|work_group|int64_atomics"'
platform=$(voxmend engines --json | sed -n -E 's/^ *"platform": "(.*)",?$/\1/p' | head -n 1)
voxmend voxelize in/cube.off -o d.npy -r 8 -q --engine opencl --device "$platform" && say "the first platform is found by its name"
voxmend voxelize in/cube.off -o d.npy -r 8 -q --engine opencl --device 0 && say "the first device is found by its number"
rm d.npy
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine opencl --device 63 2>&1 | sed "s/0 to [0-9]*/0 to N/"'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine opencl --device "no such device"'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine opencl:99 2>&1 | sed "s/0 to [0-9]*/0 to N/"'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine auto --device "no such device"'
run 'ls d.npy'

say "# several at once"
several() {
  POCL_DEVICES="pthread pthread" voxmend voxelize "$@" -o several.npy -q --engine opencl:all && cmp cpu.npy several.npy
}
run 'once in/rocket.off -r 64 && several in/rocket.off -r 64'
run 'once in/rocket.off -r 64 --mode surface && several in/rocket.off -r 64 --mode surface'
run 'once in/missing.off -r 41x30x20 --coverage 8 && several in/missing.off -r 41x30x20 --coverage 8'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine opencl:0+cpu'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine opencl:all --device 0'
run 'voxmend voxelize in/cube.off -o d.npy -r 8 --engine opencl:0:999.0 2>&1 | sed "s/has [0-9]* compute/has N compute/"'

say "# the cache"
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
make_both() {
  voxmend voxelize in/rocket.off -o one.npy -r 32 -q --engine opencl &
  voxmend voxelize in/rocket.off -o two.npy -r 32 -q --engine opencl
  wait
  cmp one.npy two.npy
}
run 'make_both; ls cache/voxmend | sed -E "s/[0-9a-f]{32}/KEY/"'
run 'for f in cache/voxmend/*.clbin; do head -c 100 "$f" >x && mv x "$f"; done; once in/rocket.off -r 32'
run 'for f in cache/voxmend/*.clbin; do dd if=/dev/zero of="$f" bs=1 seek=500 count=99 conv=notrunc status=none; done; once in/rocket.off -r 32'
run 'rm -rf cache/voxmend; : >cache/voxmend; once in/rocket.off -r 32'
XDG_CACHE_HOME=relative
run 'once in/cube.off -r 16; ls relative/voxmend'

say "# the bench compares"
run 'voxmend bench in/rocket.off -r 24 --phases solid_vote,surface_thin,sparse,coverage --engine cpu,opencl/tiles --time 0 --threads 1 --json |
  sed -n -E "s/^ *\"(phase|engine|voxels)\": //p" | paste -d " " - - -'
finish
