# SPDX-License-Identifier: BSD-3-Clause
"""Runs the blocks of pages, in order, as a reader would who types them all: blocks.py SAMPLES PAGE.md...

Each page begins in a copy of the folder SAMPLES. What the line that opens a block says, after its language:
  sh        a script, in which no command may fail
  console   commands behind "$ ", and what they print; there "..." stands for any text, and alone in a line for any lines
  python    all of a page are one program
  c, cpp    a program, or statements to which `int main(void)` is added; compiled without a warning, linked, and run
  with NAME[, NAME]     left out where the build (sh, console, c, cpp) or the interpreter (python) is without it
  not run: REASON       is left out
Blocks of other languages are no programs; each has to name its own (text). `as FILE` behind it writes the block to a file.
"""
import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import warnings

BUILD, SOURCE = os.environ["BUILDDIR"], os.environ["SRCDIR"]
CONFIG = open(os.path.join(BUILD, "config.h"), encoding="utf-8").read()
NO_PROGRAMS = {"text", "json", "glsl", "{literalinclude}", "{toctree}", "{eval-rst}"}
LIMIT_S = 120


class Failure(Exception):
    pass


def is_there(name, language):
    if language == "python":
        return importlib.util.find_spec(name) is not None
    return re.search(r"^#define HAVE_%s 1$" % re.escape(name.upper()), CONFIG, flags=re.M) is not None


def run(command, **options):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          timeout=LIMIT_S, universal_newlines=True, **options)
    return done.returncode, done.stdout


def run_sh(block, line, state):
    status, printed = run(["sh", "-euc", block])
    if status != 0:
        raise Failure("exit %d\n%s" % (status, printed))


def run_console(block, line, state):
    for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
        command, _, expected = part.partition("\n")
        printed = run(["sh", "-c", command])[1]
        pattern = re.escape(expected.strip("\n") + "\n" if expected.strip() else "")
        pattern = re.sub(r"(?m)^\\\.\\\.\\\.\\?\n", r"(?:.*\n)*", pattern).replace(r"\.\.\.", ".*")
        if not re.fullmatch(pattern, printed):
            raise Failure("$ %s\nprints\n%s\nand the page has\n%s" % (command, printed, expected))


def run_python(block, line, state):
    code = compile("\n" * line + block, state["page"], "exec")  # so that a failure names the line of the page
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        exec(code, state["scope"])


def compiled(block, line, state, suffix, compiler, standard):
    if not re.search(r"^int main\(", block, flags=re.M):
        head = "".join(found + "\n" for found in re.findall(r"^#include.*$", block, flags=re.M))
        body = re.sub(r"^#include.*\n", "", block, flags=re.M)
        block = "%sint main(void) {\n%s\nreturn 0;\n}\n" % (head, body)
    with open("block" + suffix, "w", encoding="utf-8") as file:
        file.write(block)
    libraries = os.path.join(BUILD, ".libs")
    flags = ["-std=" + standard, "-Wall", "-Wextra", "-Werror", "-I", os.path.join(SOURCE, "src"), "block" + suffix, "-o", "block",
             "-L", libraries, "-Wl,-rpath," + libraries, "-lvoxmend"]
    status, printed = run(shlex.split(compiler) + flags)
    if status == 0:
        status, printed = run(["./block"])
    if status != 0:
        raise Failure("exit %d\n%s" % (status, printed))


def run_c(block, line, state):
    compiled(block, line, state, ".c", os.environ.get("CC") or "cc", "c11")


def run_cpp(block, line, state):
    compiled(block, line, state, ".cc", os.environ.get("CXX") or "c++", "c++17")


RUNNERS = {"sh": run_sh, "console": run_console, "python": run_python, "c": run_c, "cpp": run_cpp}


def why_not(language, note, with_package):
    """Why a block is left out, or None."""
    if note.startswith("not run:"):
        if not note[8:].strip():
            raise Failure("says no reason")
        return note[8:].strip()
    if note and not note.startswith("with "):
        raise Failure("'%s' is not understood" % note)
    lacking = [name for name in note[5:].split(", ") if note and not is_there(name, language)]
    if lacking:
        return "without " + ", ".join(lacking)
    if language == "python" and not with_package:
        return "without the Python package"
    if language in ("c", "cpp") and not os.path.exists(os.path.join(BUILD, ".libs", "libvoxmend.so")):
        return "without a shared library"
    return None


def run_page(path, with_package):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    name = os.path.relpath(path, SOURCE)
    state = {"page": name, "scope": {"__name__": "__main__"}}
    ran = left_out = 0
    for found in re.finditer(r"^( *)(```+)([^\n`]*)\n(.*?)^\1\2 *$", text, flags=re.M | re.S):
        line = text[:found.start(4)].count("\n")
        language, _, note = found[3].strip().partition(" ")
        block = re.sub("^" + found[1], "", found[4], flags=re.M)
        try:
            if language in NO_PROGRAMS:
                if note.startswith("as "):
                    with open(note[3:], "w", encoding="utf-8") as file:
                        file.write(block)
                continue
            if language not in RUNNERS:
                raise Failure("the block has no language that is known: '%s'" % language)
            reason = why_not(language, note, with_package)
            if reason:
                left_out += 1
                print("%s:%d: not run: %s" % (name, line, reason))
                continue
            RUNNERS[language](block, line, state)
            ran += 1
        except Exception as failure:  # what Python's blocks raise, too
            print("FAILED: %s:%d: %s: %s" % (name, line, type(failure).__name__, failure), flush=True)
            return None
    if ran + left_out > 0:
        print("%s: %d blocks ran, %d did not" % (name, ran, left_out), flush=True)
    return ran


def main():
    samples, pages = os.path.abspath(sys.argv[1]), [os.path.abspath(page) for page in sys.argv[2:]]
    with_package = importlib.util.find_spec("voxmend") is not None
    ran, failed = 0, 0
    for page in pages:
        with tempfile.TemporaryDirectory() as folder:
            work = os.path.join(folder, "work")
            shutil.copytree(samples, work, symlinks=True)
            os.chdir(work)
            result = run_page(page, with_package)
            failed += result is None
            ran += result or 0
            os.chdir("/")
    sys.exit(failed > 0 or ran == 0)


main()
