#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Meshes through Assimp: parts and materials as tags, buffers beside the file, standard input, damage.
. "$SRCDIR/tests/cli/lib.sh"
if ! "$VOXMEND" info -q in/stool.glb 2>err.txt; then
  grep -q 'reading .glb files needs voxmend.s module "assimp".*--with-assimp.*libassimp-dev' err.txt ||
    { cat err.txt; exit 1; }
  exit 77
fi
# What Assimp says of damage is its own matter.
told() {
  "$VOXMEND" "$@" 2>&1 | sed 's/\(Assimp cannot read it\): ..*/\1: .../'
}
run 'voxmend info -v in/stool.glb'
run 'voxmend info --json - <in/stool.glb'
run 'voxmend repair -q in/stool.glb -o stool.obj && grep -E "^(g|usemtl)" stool.obj'
run 'voxmend voxelize in/stool.glb -o stool.npy --voxel-size 0.005 --mode solid'
run 'voxmend view in/stool.glb -o stool.png --up y && head -c 4 stool.png | tail -c 3'

say "# a buffer of its own, in the folder of the file"
mkdir models
# A tetrahedron: 4 x 3 numbers 0 or 1, then 12 indices of 16 bits.
zero='\0\0\0\0' one='\0\0\200\077'
printf "$zero$zero$zero$one$zero$zero$zero$one$zero$zero$zero$one" >models/wedge.bin
printf '\0\0\2\0\1\0\0\0\1\0\3\0\1\0\2\0\3\0\2\0\0\0\3\0' >>models/wedge.bin
cat >models/wedge.gltf <<'END'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"wedge","mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"buffers":[{"byteLength":72,"uri":"wedge.bin"}]}
END
run 'voxmend info models/wedge.gltf'
run 'cd models && voxmend repair -q wedge.gltf -o ../wedge.off'
run 'cat wedge.off'
run 'voxmend voxelize models/wedge.gltf -o c.npy -r 8 --mode surface --color mesh'
run 'told info - <models/wedge.gltf'
mv models/wedge.bin models/away.bin
run 'told info models/wedge.gltf'

mv models/away.bin models/wedge.bin

say "# a name in a URI: decoded once, and then a name as any other"
cp models/wedge.bin 'models/my wedge.bin'
cp models/wedge.bin 'models/100%.bin'
cp models/wedge.bin models/a%20b.bin
for uri in my%20wedge.bin ./%6d%79%20wedge.bin %77edge.bin 100%.bin a%2520b.bin; do
  say "# $uri"
  sed "s|wedge.bin|$uri|" models/wedge.gltf >models/other.gltf
  run 'voxmend info models/other.gltf --strict | grep "  volume"'
done
cp models/wedge.bin plain.bin
for uri in %2e%2e%2fplain.bin %2e./plain.bin %2Fetc%2Fpasswd %252e%252e%252fplain.bin wedge.bin%00.txt; do
  say "# $uri"
  sed "s|wedge.bin|$uri|" models/wedge.gltf >models/other.gltf
  run 'voxmend info -q models/other.gltf'
done

say "# positions in whole numbers, in a buffer beside the file and within it"
printf '\0\0\0\0\0\0\0\0\144\0\0\0\0\0\0\0\0\0\144\0\0\0\0\0\0\0\0\0\144\0\0\0' >'models/whole numbers.bin'
printf '\0\0\2\0\1\0\0\0\1\0\3\0\1\0\2\0\3\0\2\0\0\0\3\0' >>'models/whole numbers.bin'
sed -e 's|wedge.bin|whole%20numbers.bin|; s|"mesh":0}\]|"mesh":0,"scale":[0.01,0.01,0.01]}],"extensionsRequired":["KHR_mesh_quantization"]|' \
  -e 's|5126|5122|; s|"byteLength":48}|"byteLength":32,"byteStride":8}|; s|"byteOffset":48|"byteOffset":32|; s|"byteLength":72|"byteLength":56|' \
  models/wedge.gltf >models/whole.gltf
run 'voxmend info models/whole.gltf | grep -E "  volume|  bounds|closed:"'
sed "s|whole%20numbers.bin|data:application/octet-stream;base64,$(base64 <'models/whole numbers.bin' | tr -d '\n')|" \
  models/whole.gltf >within.gltf
run 'voxmend info within.gltf | grep -E "  volume|  bounds|closed:"'
sed 's|KHR_mesh_quantization|EXT_meshopt_compression|' within.gltf >packed.gltf
run 'voxmend info packed.gltf'
mv 'models/whole numbers.bin' models/away.bin
run 'voxmend info models/whole.gltf'
rm models/my* models/100* models/a%* models/away.bin plain.bin within.gltf packed.gltf

say "# a buffer of somebody else's"
cp models/wedge.bin secret.bin
ln -s ../secret.bin models/out.bin
ln -s wedge.bin models/within.bin
mkfifo models/pipe.bin
for uri in ../secret.bin "$work/secret.bin" /etc/passwd /proc/self/environ file:///etc/passwd out.bin pipe.bin .; do
  sed "s|wedge.bin|$uri|" models/wedge.gltf >models/other.gltf
  say "# $(echo "$uri" | sed "s|$work|WORK|")"
  run 'voxmend info -q models/other.gltf 2>&1 | sed "s|$work|WORK|"'
done
say "# a link that stays within; and where Assimp looks for the same name in the folder, which it finds"
for uri in within.bin ../models/wedge.bin; do
  sed "s|wedge.bin|$uri|" models/wedge.gltf >models/other.gltf
  run 'voxmend info models/other.gltf --strict | grep -E "  vertices|  faces"'
done
sed "s|wedge.bin|../secret.bin|" models/wedge.gltf >models/other.gltf
run 'voxmend info models/other.gltf --external any | grep -E "  vertices|  faces"'
run 'voxmend info models/wedge.gltf --external none'
run 'voxmend info models/wedge.gltf --external nothing'
run 'cd models && voxmend info - --external any <wedge.gltf | grep -E "  vertices|  faces"'
run 'cd models && voxmend info /dev/stdin <wedge.gltf'
ln -s models/wedge.gltf linked.gltf
run 'voxmend info linked.gltf'

say "# formats that import others"
printf 'LWSC\n3\nLoadObjectLayer 1 secret.lwo\n' >scene.lws
printf '<?xml version="1.0"?><irr_scene></irr_scene>\n' >scene.irr
printf 'version 1\n' >doll.smd
for file in scene.lws scene.irr doll.smd; do
  run "voxmend info $file"
done

say "# COLLADA comes with y upward, whatever the file says"
cat >post.dae <<'END'
<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="meter"
meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a"
count="12">0 0 0 1 0 0 0 1 0 0 0 5</float_array><technique_common><accessor source="#a" count="4" stride="3"><param name="X"
type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices
id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v"
offset="0"/><p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>
END
run 'voxmend view post.dae -o post.png -r 16'
run 'voxmend view post.dae -o y.png -r 16 --up y -q && cmp post.png y.png'
run 'voxmend view post.dae -o z.png -r 16 --up z -q && cmp -s post.png z.png'
run 'voxmend voxelize post.dae -o c.npy -r 8 --mode surface --color mesh'
rm -f post.dae post.png y.png z.png

say "# objects in files of their own within a 3MF, packed"
"${TEST_PYTHON:-python3}" - <<'END'
import zipfile
core = 'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
production = 'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="p"'
with zipfile.ZipFile("parts.3mf", "w", zipfile.ZIP_DEFLATED) as z:
    z.writestr("_rels/.rels", '<?xml version="1.0"?><Relationships '
               'xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" '
               'Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
    # Far behind the head, across the pieces in which it is unpacked.
    head = f'<?xml version="1.0"?><model {core} {production}><metadata name="a">'
    item = '</metadata><resources><object id="2"><components><component p:'
    text = head + "a" * (65536 - len(head) - len(item)) + item + (
        'path="/3D/Objects/o.model" objectid="1"/></components></object></resources><build><item objectid="2"/></build></model>')
    z.writestr("3D/3dmodel.model", text)
    z.writestr("3D/Objects/o.model", f'<?xml version="1.0"?><model {core}><resources/><build/></model>')
END
run 'voxmend info parts.3mf'
rm parts.3mf

say "# damage"
head -c 2000 in/stool.glb >cut.glb
printf 'what is this\n' >words.fbx
head -c 300 models/wedge.gltf >cut.gltf
printf '{"asset":{"version":"2.0"}}' >nothing.gltf
: >empty.glb
run 'voxmend info cut.gltf'
for file in cut.glb words.fbx nothing.gltf empty.glb; do
  run "told info $file"
done
run 'voxmend info cut.glb in/cube.off -q 2>/dev/null'
run 'voxmend repair cut.glb -o x.off 2>/dev/null'
run 'voxmend view cut.glb -o x.png 2>/dev/null'
run 'ls'
if grep -q "^#define HAVE_PNG" "$BUILDDIR/config.h"; then
  say "# colours: a texture within the file and beside it, times base colour and vertex colours"
  "${TEST_PYTHON:-python3}" "$SRCDIR/tests/cli/colors.py" make
  for mesh in square beside whole; do
    run "voxmend info $mesh.gltf | grep -E 'colours|materials|textures'"
    run "voxmend voxelize $mesh.gltf -o c.npy -q -r 8 --mode surface --color mesh && \"\${TEST_PYTHON:-python3}\" \"\$SRCDIR/tests/cli/colors.py\" list c.npy"
  done
fi
# A .glb whose picture lies beside it is no duplicate of one in another folder; one that has all in itself is.
le() {
  printf "$(printf '\\%03o\\%03o\\0\\0' $(($1 & 255)) $(($1 >> 8)))"
}
text=$(tr -d '\n' <models/wedge.gltf | sed 's/,"uri":"wedge.bin"}]/}],"images":[{"uri":"skin.png"}]/')
while [ $((${#text} % 4)) -ne 0 ]; do text="$text "; done
printf "$zero$zero$zero$one$zero$zero$zero$one$zero$zero$zero$one" >wedge.bin
printf '\0\0\2\0\1\0\0\0\1\0\3\0\1\0\2\0\3\0\2\0\0\0\3\0' >>wedge.bin
mkdir -p apart/a apart/b apart/c apart/d
for folder in a b; do
  { printf glTF; le 2; le $((28 + ${#text} + 72)); le ${#text}; printf 'JSON%s' "$text"; le 72; printf 'BIN\0'; cat wedge.bin; } >apart/$folder/m.glb
done
cp in/stool.glb apart/c/
cp in/stool.glb apart/d/
run 'voxmend batch apart -o apart-out -r 8 --format npy --pictures 0 | grep result; grep -o "duplicate_of\":\"[^\"]*" apart-out/.batch/journal-0-of-1.jsonl'
# The buffer of a .gltf belongs to what was made of it.
mkdir buffers
cp models/wedge.gltf buffers/
cp wedge.bin buffers/
{ head -c 44 wedge.bin; printf '\0\0\0\077'; tail -c 24 wedge.bin; } >half.bin
run 'voxmend batch buffers -o buffers-out -r 8 --format npy --pictures 0 | grep result && cp half.bin buffers/wedge.bin && voxmend batch buffers -o buffers-out -r 8 --format npy --pictures 0'
finish
