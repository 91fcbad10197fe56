#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend bench: every phase is measured, the voxels are those of voxelize, and what was left out is said. Figures are
# masked: how long something takes is not a matter of tests.
. "$SRCDIR/tests/cli/lib.sh"
quick='--time 0 --threads 1'

# The table with N for all numbers.
table() {
  sed -E -e '/^machine/d' -e '/left out/!s/#+/#/' -e 's/1us.*1s/1us to 1s/' -e 's/[0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)?/N/g' -e 's/ +/ /g' \
    -e '/left out/s/N (bytes|KiB|MiB|GiB|TiB)/N bytes/g' -e '/^peak memory/s/N [A-Za-z]+ (in|resident)/N MiB \1/g'
}

# The report with N for all that differs between runs, and without the machine.
report() {
  sed -E -e '/^  "machine": \{/,/^  \},?$/d' -e '/"bounds": \[/,/\]/d' \
    -e 's/("(median_ms|min_ms|per_second|of_memset|peak_bytes|peak_rss_bytes)": )[0-9][0-9.e+-]*/\1N/' \
    -e 's/("voxels": )[1-9][0-9]*/\1N/'
}

# voxels_of PHASE MESH: as the benchmark counts them.
voxels_of() {
  voxmend bench "$2" -r 24 --phases "$1" $quick --json | sed -n 's/^ *"voxels": \([0-9]*\),*$/\1/p'
}

# same PHASE OPTION...: whether voxelize sets as many.
same() {
  phase=$1
  shift
  for mesh in in/torus.off in/open_box.off in/missing.off; do
    voxmend voxelize "$mesh" -o x.npy -r 24 -q --report x.json "$@"
    made=$(sed -n 's/^  "voxels": \([0-9]*\),*$/\1/p' x.json)
    measured=$(voxels_of "$phase" "$mesh")
    [ "$made" = "$measured" ] && echo "$mesh: equal" || echo "$mesh: voxelize sets $made, bench $measured"
  done
}

run 'voxmend bench in/cube.off -r 16,8,16 --threads 2,1 --time 0 | table'
run 'voxmend bench in/cube.off -r 8 $quick --json | report'
run 'voxmend bench in/cube.off -r 16,8,16 --threads 2,1 --phases prepare,transform --time 0 --json |
  sed -n "/results/,/left_out/s/.*\"\(phase\|resolution\|threads\)\"/\1/p" | paste -d " " - - -'
run 'voxmend bench in/cube.off --phases repair,load $quick | table'
run 'voxmend bench in/cube.off --phases prepare -q $quick --report r.json && report <r.json'
run 'voxmend bench in/cube.off -r 8 $quick --json | grep -c -E "\"(processor|architecture|cores|caches|memory_bytes|huge_pages|system|compiler|voxmend)\": "'

run 'voxmend bench in/cube.off -r 8 --phases solid_x --cpu plain $quick --json | grep -o "\"vectors\": \".*\""'
run 'voxmend bench in/cube.off -r 8 --cpu sse9 $quick'

say "# the voxels of voxelize"
run 'same solid_vote'
run 'same solid_x --method x'
run 'same solid_majority --vote majority'
run 'same winding --method winding'
run 'same surface_conservative --mode surface'
run 'same surface_thin --mode surface --surface thin'
run 'same sparse --sparse'
run 'a=$(voxels_of transform in/torus.off) b=$(voxels_of solid_vote in/torus.off)
  [ $((10 * (a - b))) -lt "$b" ] && [ $((10 * (b - a))) -lt "$b" ] && echo "a small turn changes little"'

say "# variants, in three ways"
run 'voxmend bench in/torus.off -r 16,8 --augment --time 0 --threads 1,2 | table'
run 'voxmend bench in/torus.off -r 8 --phases augment_direct --displace 0.1 $quick --json | report | sed -n "/results/,/left_out/p"'
run 'TMPDIR=$work/none voxmend bench in/torus.off -r 8 --augment $quick 2>&1 | sed "s|$work|W|; s|bench\..*:|bench.X:|"'
run 'voxmend bench in/torus.off --augment --phases memset'
run 'voxmend bench in/torus.off --augment --displace 0.7'

say "# what does not fit or would take too long is left out"
run 'voxmend bench in/cube.off -r 8,2048 --memlimit 8M $quick | table'
run 'voxmend bench in/cube.off -r 2048 --memlimit 8M --phases memset,winding $quick'
run 'voxmend bench in/torus.off -r 8 --memlimit 64K $quick'

say "# the plot"
mkdir out
run 'voxmend bench in/cube.off -r 8,16 --threads 1,2 --time 0 -q --plot out/a\&b.SVG && ls out'
run 'grep -c "<polyline " out/a\&b.SVG; grep -o -E ">(cube.off|milliseconds|resolution|solid_vote|winding|[12] threads?)\b" out/a\&b.SVG'
run 'grep -E "href|url\(|<script|<image" out/a\&b.SVG'
if [ -n "$TEST_PYTHON" ]; then
  "$TEST_PYTHON" -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' 'out/a&b.SVG'
fi
rm out/*
run 'voxmend bench in/cube.off -r 8 $quick --plot no/such/x.svg'
run 'voxmend bench missing.off -r 8 $quick --plot out/x.svg --report out/r.json'
run 'voxmend bench in/cube.off -r 8 $quick --plot out/x.svg --report no/such/r.json'
run 'voxmend bench in/cube.off -r 8 $quick --json --plot out/x.svg >/dev/full 2>/dev/null'
run 'ls out'

say "# meshes that cannot be measured, and warnings"
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' >flat.off
head -n 28 in/star_prism.off >cut.off
run 'voxmend bench flat.off -r 8 $quick'
run 'voxmend bench cut.off -r 8 --phases load $quick --strict | table'
run 'voxmend bench cut.off -r 8 --phases load $quick --strict -q'
run 'voxmend bench in/cube.off -r 8 --phases memset,solid_x $quick -q --progress always'
finish
