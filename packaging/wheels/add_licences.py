# SPDX-License-Identifier: BSD-3-Clause
"""add_licences.py WHEEL FOLDER: writes the wheel anew into FOLDER, with the licences of the libraries that auditwheel has put
into it, as Debian has them, and with what its metadata says of them. A library that is not in the list below fails: somebody has
to read its licence first. In the Debian that the wheel was built in; needs the package wheel."""
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile

# Debian's source packages, and the licence of what the wheel has of them. None of it is under the GPL.
LICENCES = {
    "assimp": "BSD-3-Clause AND BSL-1.0 AND MIT",
    "bzip2": "bzip2-1.0.6",
    "hdf5": "BSD-3-Clause",
    "jansson": "MIT",
    "libaec": "BSD-2-Clause",
    "libzstd": "BSD-3-Clause",
    "libarchive": "BSD-2-Clause",
    "libjpeg-turbo": "IJG AND BSD-3-Clause AND Zlib",
    "libpng1.6": "libpng-2.0",
    "libseccomp": "LGPL-2.1-only",
    "minizip": "Zlib",
    "nettle": "LGPL-3.0-or-later",
    "octomap": "BSD-3-Clause",
    "openmesh": "BSD-3-Clause",
    "sqlite3": "blessing",
    "xz-utils": "0BSD",
    "zlib": "Zlib",
}
# Those that packaging/wheels/newer-libraries has built; they are linked into files of voxmend.
BUILT = "/usr/src/newer"

WORDS = """The libraries in the folder voxmend.libs, and those that are linked into voxmend's own files, are those of Debian, as it
distributes them; their names and the folders in which they look for each other were changed by auditwheel.

{rows}

The file of each is what Debian tells of its copyright and licence; the licences that these refer to are here, too. They tell of
tools, tests and packaging as well, of which some are under the GNU General Public License: none of these is here. The sources
are in Debian's archive, of each version that it has had on snapshot.debian.org. The libraries under the GNU Lesser General Public
License are files of their own, which can be replaced by others with the same interface.
"""


def output(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def package_of(library):
    """Debian's binary package of a library that auditwheel has renamed: libpng16-1b4b0e2e.so.16.37.0."""
    name = re.sub(r"-[0-9a-f]{8}(?=\.so)", "", os.path.basename(library))
    for folder in ("/usr/lib/x86_64-linux-gnu", "/lib/x86_64-linux-gnu", "/usr/lib", "/lib"):
        for path in [os.path.join(folder, name)] + glob.glob(os.path.join(folder, "**", name), recursive=True):
            if os.path.exists(path):
                for known in (path, path[len("/usr"):] if path.startswith("/usr") else "/usr" + path):
                    found = subprocess.run(["dpkg", "-S", known], capture_output=True, text=True)
                    if found.returncode == 0:
                        return found.stdout.split(":")[0]
    sys.exit("add_licences.py: no package of Debian has %s" % name)


def sources_of(libraries):
    """Of each library's source package, the version, and the file that tells of its licence."""
    found = {}
    for library in libraries:
        package = package_of(library)
        source, version = output("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package).split()
        found[source] = (version, "/usr/share/doc/%s/copyright" % package)
    for folder in glob.glob(BUILT + "/*/debian"):
        source, version = (output("dpkg-parsechangelog", "-l", folder + "/changelog", "-S", field).strip()
                           for field in ("Source", "Version"))
        found[source] = (version, folder + "/copyright")
    for source in found:
        if source not in LICENCES:
            sys.exit("add_licences.py: %s is not in the list: read its licence first" % source)
    return dict(sorted(found.items()))


def main():
    wheel, folder = sys.argv[1:]
    work = tempfile.mkdtemp()
    output("wheel", "unpack", "--dest", work, wheel)
    tree, = glob.glob(work + "/*")
    info, = glob.glob(tree + "/*.dist-info")
    licences = os.path.join(info, "licenses", "libraries")
    os.makedirs(licences)
    sources = sources_of(glob.glob(tree + "/voxmend.libs/*"))
    texts = set()
    for source, (_, path) in sources.items():
        shutil.copyfile(path, os.path.join(licences, source + ".txt"))
        with open(path, encoding="utf-8", errors="replace") as file:
            texts |= set(re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])", file.read()))
    if any("LGPL-3" in LICENCES[source] for source in sources):
        texts |= {"LGPL-3", "GPL-3"}  # the former adds to the latter
    for text in sorted({os.path.basename(os.path.realpath("/usr/share/common-licenses/" + text)) for text in texts}):
        shutil.copyfile("/usr/share/common-licenses/" + text, os.path.join(licences, text + ".txt"))
    with open(os.path.join(licences, "README.txt"), "w", encoding="utf-8") as file:
        file.write(WORDS.format(rows="\n".join("%s %s: %s" % (source, version, LICENCES[source]) for source, (version, _) in sources.items())))

    path = os.path.join(info, "METADATA")
    with open(path, encoding="utf-8") as file:
        head, _, rest = file.read().partition("\n\n")
    expressions = sorted({part for source in sources for part in LICENCES[source].split(" AND ")} - {"BSD-3-Clause"})
    own = "License-Expression: BSD-3-Clause"
    assert own in head.split("\n"), head
    head = head.replace(own, " AND ".join([own] + expressions))
    head += "".join("\nLicense-File: libraries/" + name for name in sorted(os.listdir(licences)))
    with open(path, "w", encoding="utf-8") as file:
        file.write(head + "\n\n" + rest)
    os.makedirs(folder, exist_ok=True)
    print(output("wheel", "pack", "--dest-dir", folder, tree), end="")
    shutil.rmtree(work)


main()
