#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Completion: the tables agree with --help, bash completes as its readline asks for it, and zsh and fish do where they
# are installed.
set -eu
command -v bash >/dev/null || exit 77
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-completion.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/files"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$VOXMEND" >"$work/bin/voxmend"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$BUILDDIR/binvox" >"$work/bin/binvox"
chmod +x "$work/bin/voxmend" "$work/bin/binvox"
PATH=$work/bin:$PATH
export PATH
cd "$work/files"
: >chair.off
: >"my table.off"
mkdir models
bad=0
fail() {
  echo "FAILED: $1"
  bad=1
}

# ---- The tables are what --help shows ----
for command in $(voxmend help --table | cut -f 1); do
  voxmend help --table "$command" | cut -f 1 | sort >"$work/table"
  voxmend "$command" --help | grep -oE '^ {2,6}(-., )?--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+' | sort >"$work/help"
  cmp -s "$work/table" "$work/help" || fail "help --table $command and $command --help list different options"
done

# ---- bash: a session at a terminal, with tabs ----
# What stands on the line when tab was pressed behind the words.
complete_bash() {
  bash --norc --noprofile -c '
    source "$1"
    COMP_LINE=$2
    COMP_POINT=${#COMP_LINE}
    read -ra COMP_WORDS <<<"${COMP_LINE//=/ = }"
    [[ $COMP_LINE == *" " ]] && COMP_WORDS+=("")
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    compopt() { :; } # works within a real completion alone
    "_${COMP_WORDS[0]}" "${COMP_WORDS[0]}" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
    printf "%s " "${COMPREPLY[@]}"' bash "$SRCDIR/completions/voxmend.bash" "$1"
}
expect_bash() {
  got=$(complete_bash "$1")
  [ "$got" = "$2 " ] || fail "bash completes '$1' to '$got' and not '$2'"
}
expect_bash 'voxmend vox' 'voxelize'
expect_bash 'voxmend re' 'repair remesh'
expect_bash 'voxmend --v' '--version'
expect_bash 'voxmend help com' 'combine compare'
expect_bash 'voxmend voxelize --res' '--resolution'
expect_bash 'voxmend voxelize --mode ' 'solid surface both'
expect_bash 'voxmend voxelize --mode s' 'solid surface'
expect_bash 'voxmend voxelize --mode=b' 'both'
expect_bash 'voxmend voxelize chair.off --thin ' 'keep drop 26'
expect_bash 'voxmend repair chair.off --level c' 'clean closed'
expect_bash 'voxmend voxelize -o ' ''
expect_bash 'voxmend voxelize --json c' ''
expect_bash 'voxmend batch models --vo' '--voxel-size --vote'
expect_bash 'voxmend batch models --conf' ''
expect_bash 'voxmend nonsense --x' ''
expect_bash 'binvox -rot' '-rotx -roty -rotz'
expect_bash 'binvox -d 64 -t sch' 'schematic'
expect_bash 'voxmend binvox -dm' '-dmin'
expect_bash 'binvox chair' ''

# The same with keys on a real terminal, where there is one to be had.
if command -v python3 >/dev/null; then
  python3 - "$SRCDIR/completions/voxmend.bash" <<'END' || bad=1
import concurrent.futures, os, pty, re, select, sys, time

def session(typed):
    pid, fd = pty.fork()
    if pid == 0:
        os.environ.update(TERM="dumb", PS1="> ", INPUTRC="/dev/null", HISTFILE="")
        os.execvp("bash", ["bash", "--norc", "--noprofile", "-i"])
    got = b""
    def read(until, limit=20):
        nonlocal got
        end = time.time() + limit
        while until not in got and time.time() < end:
            if select.select([fd], [], [], 0.1)[0]:
                try:
                    got += os.read(fd, 4096)
                except OSError:
                    return
    os.write(fd, b"bind 'set bell-style none'; bind 'set enable-bracketed-paste off'; source '%s'; echo READ''Y\n" % sys.argv[1].encode())
    read(b"READY")
    # What is on the line becomes the argument of echo once the completion is through.
    os.write(fd, typed.encode())
    time.sleep(1.5)
    os.write(fd, b"\x01echo LINE: \x05 :END\n")
    read(b":END\r\n" if b":END\r\n" in got else b"\nLINE:")
    time.sleep(0.3)
    read(b"\0", 0.5)
    os.close(fd)
    os.waitpid(pid, 0)
    found = re.findall(rb"(?m)^LINE: (.*?) *:END", got.replace(b"\r", b""))
    return found[-1].decode() if found else repr(got)

bad = 0
sessions = [("voxmend voxe\t", "voxmend voxelize"),
            ("voxmend voxelize --resol\t64 ch\t", "voxmend voxelize --resolution 64 chair.off"),
            ("voxmend voxelize my\t--mode su\t", "voxmend voxelize my table.off --mode surface"),
            ("binvox -dm\t4 ch\t", "binvox -dmin 4 chair.off"),
            ("voxmend repair -o mod\t", "voxmend repair -o models/"),
            ("voxmend voxelize --mode=b\t", "voxmend voxelize --mode=both")]
with concurrent.futures.ThreadPoolExecutor(len(sessions)) as pool: # each waits for keys most of the time
    found = pool.map(session, [typed for typed, _ in sessions])
for (typed, wanted), got in zip(sessions, found):
    if got != wanted:
        print("FAILED: bash at a terminal makes %r of %r and not %r" % (got, typed, wanted))
        bad = 1
sys.exit(bad)
END
fi

# ---- zsh and fish ----
if command -v zsh >/dev/null; then
  zsh -n "$SRCDIR/completions/_voxmend" || fail "zsh does not read its completion"
fi
if command -v fish >/dev/null; then
  expect_fish() {
    got=$(HOME=$work fish --no-config -c "source '$SRCDIR/completions/voxmend.fish'; complete -C '$1'" | cut -f 1 | tr '\n' ' ')
    [ "$got" = "$2 " ] || fail "fish completes '$1' to '$got' and not '$2'"
  }
  expect_fish 'voxmend vox' 'voxelize'
  expect_fish 'voxmend voxelize --res' '--resolution'
  expect_fish 'voxmend voxelize --mode s' 'solid surface'
fi
exit "$bad"
