#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The page that a batch leaves, in a browser without a window: it shows all, sorts, filters, and fetches nothing.
set -eu
browser=
for name in chromium chromium-browser google-chrome; do
  if command -v "$name" >/dev/null; then browser=$name && break; fi
done
[ -n "$browser" ] || { echo "no Chromium"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-page.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $1"
  exit 1
}
mkdir -p "$work/in/<" # with the name below it, what would end a script
"$BUILDDIR/samples/generate_samples" "$work/in"
printf 'OFF\n3 1 0\n0 0 0\n' >"$work/in/</script><b>&.off"
"$VOXMEND" batch "$work/in" -o "$work/out" -r 16 -q
page=$work/out/index.html
grep -qE '(src|href)="?(https?:)?//' "$page" && fail "it refers to a network"
# What a person does, and what is there then, is written into the page that is dumped.
cat >"$work/acts.js" <<'END'
<script>
  const names = () => [...document.querySelectorAll("#rows tr")].map(r => r.children[0].textContent);
  const out = [];
  const note = (what, value) => out.push("RESULT " + what + ": " + value);
  note("rows", names().length);
  note("pictures", [...document.images].filter(i => i.complete && i.naturalWidth > 0).length);
  document.querySelectorAll("#head th")[0].click();
  note("sorted", names().every((n, i, all) => !i || all[i - 1] <= n));
  document.querySelectorAll("#head th")[0].click();
  note("turned", names().every((n, i, all) => !i || all[i - 1] >= n));
  const filter = document.getElementById("filter");
  filter.value = "sphere";
  filter.dispatchEvent(new Event("input"));
  note("filtered", names().join());
  filter.value = "";
  filter.dispatchEvent(new Event("input"));
  [...document.querySelectorAll("#counts button")].find(b => b.textContent.includes("unreadable")).click();
  note("unreadable", names().join());
  note("command", document.querySelector("#rows code").textContent.startsWith("voxmend voxelize"));
  note("foreign", document.querySelectorAll("b").length === document.querySelectorAll("#counts b").length);
  document.body.append(Object.assign(document.createElement("pre"), {textContent: out.join("\n")}));
</script>
END
cat "$page" "$work/acts.js" >"$work/acted.html"
"$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$work/profile" --virtual-time-budget=5000 --dump-dom "file://$work/acted.html" >"$work/dom" 2>/dev/null
grep -o 'RESULT [^<]*' "$work/dom" >"$work/results" || true
cat "$work/results"
meshes=$(find "$work/in" -name "*.off" | wc -l)
expect() {
  grep -qxF "RESULT $1" "$work/results" || fail "not so: $1"
}
[ "$(sed -n 's/RESULT rows: //p' "$work/results")" -ge "$meshes" ] || fail "fewer than $meshes rows"
expect "sorted: true"
expect "turned: true"
expect "filtered: sphere.off"
expect "unreadable: &lt;/script&gt;&lt;b&gt;&amp;.off"
expect "command: true"
expect "foreign: true"
if ! "$VOXMEND" view "$work/out/cube.binvox" -o "$work/cube.png" -q 2>/dev/null; then exit 0; fi
[ "$(sed -n 's/RESULT pictures: //p' "$work/results")" -ge 20 ] || fail "pictures are missing"
