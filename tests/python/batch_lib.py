# SPDX-License-Identifier: BSD-3-Clause
"""A small dataset for the tests of voxmend.batch: classes and splits as ModelNet's, with what real ones have: one mesh that
is damaged, one that stands twice, names with dots and blanks. SAMPLES is a folder of what samples/generate_samples makes."""
import hashlib
import os
import shutil

SAMPLES = os.environ["SAMPLES"]
MODELS = {
    "ring/train": ["torus", "soup", "cracks"], "ring/test": ["torus"], "prism/train": ["star_prism", "l_prism"],
    "prism/test": ["rocket"], "ball/train": ["sphere", "flipped", "repeated"], "ball/test": ["doubled"],
}


def make_dataset(folder, copies=1):
    """Writes it and returns how many files there are. Copies differ in a comment, so that none is a duplicate."""
    count = 0
    for place, models in MODELS.items():
        at = os.path.join(folder, place)
        os.makedirs(at)
        for model in models:
            for copy in range(copies):
                with open(os.path.join(SAMPLES, model + ".off"), "rb") as file:
                    data = file.read()
                with open(os.path.join(at, "%s %d.v1.off" % (model, copy)), "wb") as file:
                    file.write(data + (b"# %d\n" % copy if copy else b""))
                count += 1
    with open(os.path.join(folder, "ring", "train", "damaged.off"), "w") as file:
        file.write("OFF\n3 nothing\n")
    return count + 1


def outputs(folder):
    """{name: SHA-256} of what a batch has made, its own records apart."""
    found = {}
    for at, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if name != ".batch"]
        for name in names:
            path = os.path.join(at, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = hashlib.sha256(file.read()).hexdigest()
    for own in ("summary.json", "failures.tsv", "index.html"):
        found.pop(own, None)
    return found


def make_batch(folder, *words, **arguments):
    """The dataset in folder/in and a batch of it in folder/out."""
    import voxmend.batch
    make_dataset(os.path.join(folder, "in"))
    return voxmend.batch.run(os.path.join(folder, "in"), os.path.join(folder, "out"), options=words, **arguments)


def remove(path):
    shutil.rmtree(path, ignore_errors=True)
