#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A wheel that is packed of this build has all that belongs into one, says so in its metadata, and does its work where it is
# unpacked; the archive for PyPI has all, too. packaging/try-wheels tries the real ones.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c 'import wheel' 2>/dev/null; then
  echo "SKIPPED: $PYTHON makes no wheels (Debian: python3-wheel)"
  exit 77
fi
unset PYTHONPATH MAKEFLAGS MFLAGS MAKELEVEL
cp -r "$SRCDIR/python" source
chmod -R u+w source
rm -rf source/build source/*.egg-info

# ---- What is in it ----
(cd source && CFLAGS=-O0 VOXMEND_BUILD=$BUILDDIR "$PYTHON" -c 'from setuptools import build_meta; build_meta.build_wheel("..")' >../log 2>&1) || { cat log; exit 1; }
parts=$(printf 'include Makefile\nprint-parts:\n\t@echo $(pkglib_LTLIBRARIES) $(modules_PROGRAMS) $(unpack_PROGRAMS)\n' |
  make -s --no-print-directory -C "$BUILDDIR" -f - print-parts)
# shellcheck disable=SC2086 # words
"$PYTHON" - "$SRCDIR" $parts <<'EOF'
import email, glob, os, re, stat, sys, zipfile
source, *parts = sys.argv[1:]
path, = glob.glob("*.whl")
with open(source + "/configure.ac") as file:
    version = re.search(r"AC_INIT\(\[voxmend\], \[(.*)\]\)", file.read())[1]
assert path.startswith("voxmend-%s-cp39-abi3-linux_" % version), path
archive = zipfile.ZipFile(path)
names = set(archive.namelist())
info, data = "voxmend-%s.dist-info/" % version, "voxmend-%s.data/" % version
wanted = {"voxmend/" + os.path.basename(p) for p in glob.glob(source + "/python/voxmend/*") if os.path.isfile(p)}
wanted |= {"voxmend/_voxmend.abi3.so", "voxmend/lib/libvoxmend.so.1", "voxmend/bin/voxmend", "voxmend/bin/binvox"}
wanted |= {"voxmend/lib/voxmend/" + name.replace(".la", ".so") for name in parts}
if "voxmend-unpack" in parts:  # beside the program, which looks for it there
    wanted = wanted - {"voxmend/lib/voxmend/voxmend-unpack"} | {"voxmend/bin/voxmend-unpack"}
wanted |= {data + "scripts/voxmend", data + "scripts/binvox", data + "data/share/man/man1/voxmend.1"}
wanted |= {info + name for name in ("METADATA", "RECORD", "WHEEL", "top_level.txt")}
extra = {name for name in names - wanted if not name.endswith("/LICENSE")}
assert names - extra - wanted and not wanted - names and not extra, (sorted(wanted - names), sorted(extra))
for name in names:
    is_program = name.startswith("voxmend/bin/") or name.endswith("-reader") or "/scripts/" in name
    assert archive.getinfo(name).external_attr >> 16 & stat.S_IXUSR or not is_program, name
head = email.message_from_bytes(archive.read(info + "METADATA"))
assert (head["Name"], head["Version"], head["Requires-Python"]) == ("voxmend", version, ">=3.9")
assert "BSD-3-Clause" in (head["License-Expression"], head["License"]) and head["License-File"] == "LICENSE"
assert head["Description-Content-Type"] == "text/markdown" and head["Summary"] and head["Author"]
assert {re.split("[<>= ;]", line)[0] for line in head.get_all("Requires-Dist")} >= {"numpy", "cffi"}
assert "Typing :: Typed" in head.get_all("Classifier")
assert b"Root-Is-Purelib: false" in archive.read(info + "WHEEL")
for name in names:  # as pip does
    place = archive.extract(name, "site")
    os.chmod(place, 0o644 | (archive.getinfo(name).external_attr >> 16 & 0o111))
EOF

# ---- The package finds the library, and its scripts the programs ----
export PYTHONPATH="$SAMPLES/site"
"$PYTHON" -c 'import voxmend; assert "/site/" in voxmend.__file__; voxmend.voxelize("rocket.off", 16).save("one.npy")'
# This build's programs look for the library as any do: `configure --enable-wheel` is for those of the real wheel.
export LD_LIBRARY_PATH="$SAMPLES/site/voxmend/lib"
scripts=$(echo site/voxmend-*.data/scripts)
head -n 1 "$scripts/voxmend" | grep -qx '#!python' # for pip to put an interpreter there
"$PYTHON" "$scripts/voxmend" voxelize rocket.off -o two.npy -r 16 >log 2>&1 || { cat log; exit 1; }
"$PYTHON" -m voxmend compare one.npy two.npy >log || { cat log; exit 1; }
cp rocket.off other.off
"$PYTHON" "$scripts/binvox" -d 16 other.off >log 2>&1 || { cat log; exit 1; }
[ -s other.binvox ]
status=0
"$PYTHON" "$scripts/voxmend" info nothing.off 2>log || status=$?
[ "$status" -eq 1 ]

# ---- The archive for PyPI, of a small stand-in for what `make dist` makes ----
unset LD_LIBRARY_PATH PYTHONPATH
name=voxmend-$(sed -n 's/^AC_INIT(\[voxmend\], \[\(.*\)\])$/\1/p' "$SRCDIR/configure.ac")
mkdir -p "$name/src/modules/cgal"
cp -r "$SRCDIR/python" "$name/"
chmod -R u+w "$name"
rm -rf "$name/python/build" "$name"/python/*.egg-info
cp "$SRCDIR/configure.ac" "$name/"
touch "$name/configure" "$name/src/voxmend.h" "$name/src/modules/cgal/union.cc"
tar cf dist.tar "$name"
for folder in first second; do
  PYTHON=$PYTHON "$SRCDIR/packaging/make-sdist" dist.tar "$folder" >log 2>&1 || { cat log; exit 1; }
done
cmp "first/$name.tar.gz" "second/$name.tar.gz"
tar tzf "first/$name.tar.gz" >content
for file in PKG-INFO build_library.py build_voxmend.py scripts/voxmend scripts/binvox setup.py library/configure library/src/voxmend.h; do
  grep -qxF "$name/$file" content || { echo "FAILED: no $file in the archive"; exit 1; }
done
if grep cgal content; then
  echo "FAILED: what is under the GPL is in the archive"
  exit 1
fi
if tar xzOf "first/$name.tar.gz" "$name/PKG-INFO" | grep -F '](../'; then
  echo "FAILED: links to nowhere"
  exit 1
fi
