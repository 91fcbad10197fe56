#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The page of voxmend view, in a browser without a window: it shows what the files hold, and switches it.
set -eu
browser=
for name in chromium chromium-browser google-chrome; do
  if command -v "$name" >/dev/null; then browser=$name && break; fi
done
[ -n "$browser" ] || { echo "no Chromium"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-view.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir in
"$BUILDDIR/samples/generate_samples" in
fail() {
  echo "FAILED: $1"
  exit 1
}
voxmend() {
  "$VOXMEND" "$@"
}

# Opens a page, and when it has been drawn runs what stands on standard input, which calls note(name, value).
act() {
  grep -qE '(src|href)="?(https?:)?//' "$1" && fail "$1 refers to a network"
  {
    cat "$1"
    cat <<'PAGE'
<script>
      const results = [];
      const note = (name, value) => results.push(`RESULT ${name}: ${value}`);
      const set = (id, value) => {
        const input = document.getElementById(id);
        input.value = value;
        input.dispatchEvent(new Event("input"));
      };
      const sum = () => {
        const v = window.voxmendView.voxels, [nx, ny] = v.dims, table = v.table(), step = v.isColor ? 4 : 1;
        let sum = 0;
        for (let i = 0; i < v.codes.length / step; i++)
          if (table[v.codes[step * i + step - 1]]) sum += (i % nx) ** 2 + 1000 * ((i / nx | 0) % ny) + 1000000 * (i / nx / ny | 0);
        return sum;
      };
      const told = document.documentElement.dataset;
      addEventListener("error", (event) => note("error", event.message));
      const wait = setInterval(() => {
        if (!told.ready) return;
        clearInterval(wait);
        note("ready", told.ready);
        if (told.ready === "failed") note("message", document.getElementById("message").textContent);
        else {
          note("voxels", told.voxels);
          const { width, height } = document.getElementById("view"), gl = window.voxmendView.gl;
          const pixels = new Uint8Array(4 * width * height);
          gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
          note("drawn", pixels.filter((value, n) => n % 4 === 2 && value < 230).length > 200);
          try { act(); } catch (error) { note("error", error); }
        }
        document.body.append(Object.assign(document.createElement("pre"), {textContent: results.join("\n")}));
      }, 20);
      function act() {
PAGE
    cat
    echo '} </script>'
  } >acted.html
  "$browser" --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --user-data-dir="$work/profile" \
    --window-size=500,400 --virtual-time-budget=10000 --dump-dom "file://$work/acted.html" --enable-logging=stderr >dom 2>log
  grep -o 'RESULT [^<]*' dom | grep -v '\$' >results || true
  echo "== $1"
  cat results
  if grep -q 'RESULT message: .*WebGL' results; then
    echo "this Chromium has no WebGL 2"
    exit 77
  fi
  grep CONSOLE log | grep -v "GL Driver Message" && fail "$1 says something"
  expect "ready: yes"
  expect "drawn: true"
  grep -q "RESULT error" results && fail "$1 has an error"
  true
}
expect() {
  grep -qxF "RESULT $1" results || fail "not so: $1"
}
count() {
  voxmend info "$1" | sed -n 's/^voxels *\([0-9]*\).*/\1/p'
}
# The sum of x^2 + 1000 y + 1000000 z over the voxels of a grid of 24 along each axis, from the bytes of a .npy.
sum() {
  tail -c 13824 "$1" | od -An -v -tu1 -w1 | awk '$1 { n = NR - 1; sum += int(n / 576) ^ 2 + 1000 * (int(n / 24) % 24) + 1000000 * (n % 24) } END { printf "%.0f\n", sum }'
}

# Bits: those of the file, in their places.
voxmend voxelize in/bunny.off -o t.npy -r 24 -q 2>/dev/null || voxmend voxelize in/torus.off -o t.npy -r 24 -q
voxels=$(voxmend view t.npy -o t.html | sed -n 's/^voxels *//p')
act t.html <<'END'
  note("sum", sum());
  const view = window.voxmendView;
  set("slice-z", 12);
  view.draw(1);
  note("cut", `${view.state.low} ${view.state.high}`);
END
expect "voxels: $voxels"
expect "sum: $(sum t.npy)"
expect "cut: 0,0,0 24,24,12"

# Distances: below 0 at first, then what convert takes.
voxmend voxelize in/torus.off -o d.npy -r 24 --distance signed -q
voxmend view d.npy -o d.html -q
voxmend convert d.npy -o inside.npy --below 0 -q
voxmend convert d.npy -o wider.npy --below 0.1 -q
act d.html <<'END'
  note("sum", sum());
  window.voxmendView.voxels.setBounds(null, 0.1);
  window.voxmendView.march.update();
  note("wider", sum());
  set("slice-x", 12);
  window.voxmendView.camera.look(0, 0); // along x: the plane has the colours of its values
  window.voxmendView.draw(1);
  const { width, height } = document.getElementById("view");
  const [red, , blue] = window.voxmendView.pixel(width >> 1, height >> 1);
  note("plane", red !== blue);
END
expect "sum: $(sum inside.npy)"
expect "wider: $(sum wider.npy)"
expect "plane: true"

# Coverage, with a threshold, and colours.
voxmend voxelize in/torus.off -o c.npy -r 24 --coverage 4 -q
voxmend convert c.npy -o most.npy --threshold 0.7 -q
voxmend view c.npy -o c.html --threshold 0.7 -q
act c.html <<'END'
  note("sum", sum());
END
expect "sum: $(sum most.npy)"
voxmend voxelize in/torus.off -o solid.npy -r 24 -q
voxmend voxelize in/torus.off -o k.npy -r 24 --color position -q
voxmend view k.npy -o k.html -q
act k.html <<'END'
  note("sum", sum());
END
expect "sum: $(sum solid.npy)"

# Labels whose names look like HTML: as text, and to be switched.
cat >two.obj <<'END'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v 3 0 0
v 4 0 0
v 3 1 0
v 3 0 1
g first
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
g plain
f 5 7 6
f 5 6 8
f 6 7 8
f 5 8 7
END
voxmend voxelize two.obj -o '<b>&.npy' -r 24 --labels group -q
sed -i 's|"first"|"</script><b>bold</b>"|' *.json
voxmend view '<b>&.npy' -o l.html -q
act l.html <<'END'
  const lines = [...document.querySelectorAll(".legend button")], counts = about.labels.map((line) => line.count);
  note("labels", lines.length);
  note("name", lines[0].querySelector(".name").textContent === "1 </" + "script><b>bold</b>");
  note("title", document.getElementById("title").textContent === "<b>&.npy");
  note("foreign", document.querySelectorAll("b").length);
  note("all", counts[0] + counts[1] === +told.voxels);
  lines[0].click();
  note("one", window.voxmendView.voxels.count === counts[1]);
  lines[0].dispatchEvent(new Event("dblclick"));
  note("other", window.voxmendView.voxels.count === counts[0]);
END
for what in "labels: 2" "name: true" "title: true" "foreign: 0" "all: true" "one: true" "other: true"; do expect "$what"; done

# A mesh with a hole: its rim, its open part and what a repair adds; a face twice, and a sheet apart.
cat >open.off <<'END'
OFF
11 13 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
2 0 0
3 0 0
2 1 0
3 0 3 2
3 0 2 1
3 0 1 5
3 0 5 4
3 1 2 6
3 1 6 5
3 2 3 7
3 2 7 6
3 3 0 4
3 3 4 7
3 4 5 6
3 4 5 6
3 8 9 10
END
voxmend view open.off -o open.html -r 32 -q
act open.html <<'END'
  const view = window.voxmendView;
  for (const layer of about.mesh.layers) note(layer.name, layer.count);
  note("triangles", view.overlay.mesh.elements / 3);
  for (const box of document.querySelectorAll("#controls label input")) box.click();
  view.draw(1);
  note("layers", view.overlay.layers.every((layer) => layer.on !== (layer.what === "boundary_edge")));
END
for what in "triangles: 13" "open edges: 5" "repeated faces: 1" "open parts: 13" "layers: true"; do expect "$what"; done
grep -q "RESULT added by repair: " results || fail "nothing is added by repair"

# What is too large is refused in one line, and leaves no file.
printf '#binvox 1\ndim 2049 1 1\ntranslate 0 0 0\nscale 1\ndata\n' >long.binvox
i=0
while [ "$i" -lt 8 ]; do printf '\000\377' && i=$((i + 1)); done >>long.binvox
printf '\001\011' >>long.binvox
voxmend view long.binvox -o long.html 2>err && fail "a page of 2049 voxels along a side"
cat err
[ "$(grep -c 'up to 2048 voxels along an axis' err)" = 1 ] || fail "no line that tells why"
[ ! -e long.html ] || fail "a page was left"
