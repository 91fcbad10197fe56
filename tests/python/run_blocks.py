# SPDX-License-Identifier: BSD-3-Clause
"""Runs the blocks of Python of a page, one after another, as one program: run_blocks.py PAGE.md... A block whose first line is
"# with PACKAGE" is left out where there is no such package. The present folder has the files that the page names."""
import importlib.util
import re
import sys
import warnings

warnings.simplefilter("ignore")
for path in sys.argv[1:]:
    with open(path, encoding="utf-8") as file:
        text = file.read()
    scope, ran = {"__name__": "__main__"}, 0
    for found in re.finditer(r"^```python\n(.*?)^```$", text, flags=re.M | re.S):
        block, line = found[1], text[:found.start(1)].count("\n")
        wanted = re.match(r"# with (\w+)", block)
        if wanted and importlib.util.find_spec(wanted[1]) is None:
            print("%s:%d: without %s" % (path, line + 1, wanted[1]))
            continue
        exec(compile("\n" * line + block, path, "exec"), scope)  # so that a failure names the line of the page
        ran += 1
    print("%s: %d blocks" % (path, ran))
    assert ran > 0, path
