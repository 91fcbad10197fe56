# SPDX-License-Identifier: BSD-3-Clause
"""Pages of the commands, made of their manual pages: command_pages.py OUTPUT INTRODUCTION.md voxmend-COMMAND.1...
It knows the macros and escapes that these use, and refuses any other. Options become targets that the search finds."""
import os
import re
import sys

ESCAPES = {r"\-": "-", r"\(mu": "×", r"\(dq": '"', r"\&": "", r"\e": "\\", r"\|": "", r"\ ": " "}
FONTS = {"B": "``", "I": "*", "R": "", "P": ""}
LEFT_OUT = {"NAME", "SYNOPSIS", "SEE ALSO"}


def runs_of(text, font="R"):
    """[(font, text)] of a line with escapes."""
    found = []
    for part in re.split(r"(\\f[A-Z]|\\\(..|\\.)", text):
        if part.startswith(r"\f"):
            font = part[2]
        elif part.startswith("\\"):
            found.append((font, ESCAPES[part]))
        elif part:
            found.append((font, part))
    merged = []
    for font, part in found:
        if merged and merged[-1][0] == font:
            merged[-1] = (font, merged[-1][1] + part)
        else:
            merged.append((font, part))
    return merged


def arguments(text):
    return [quoted or plain for quoted, plain in re.findall(r'"([^"]*)"|(\S+)', text)]


def styled(line):
    """Runs of a line that is text or a macro for fonts."""
    found = re.match(r"\.(BR|RB|IR|RI|B|I)\s+(.*)", line)
    if not found:
        return runs_of(line)
    fonts, words = found[1], arguments(found[2])
    if len(fonts) == 1:
        return runs_of(" ".join(words), fonts)
    return [run for i, word in enumerate(words) for run in runs_of(word, fonts[i % 2])]


def plain(runs):
    return "".join(text for _, text in runs)


def marked_up(runs):
    """As reStructuredText."""
    out = ""
    for font, text in runs:
        mark = FONTS[font]
        if not mark or not text.strip():
            out += re.sub(r"([*`|\\])", r"\\\1", text) if text.strip() else text
            continue
        before, after = text[:len(text) - len(text.lstrip())], text[len(text.rstrip()):]
        out += before + "\0" + mark + text.strip() + mark + "\0" + after
    # Marks have to stand apart from letters: "\ " does that and leaves nothing.
    out = re.sub(r"\0\0", r"\\ ", out)
    out = re.sub(r"(?<![\s(\"])\0(?=[`*])", r"\\ ", out)
    out = re.sub(r"(?<=[`*])\0(?![\s.,;:)!?\"]|$)", r"\\ ", out)
    return out.replace("\0", "").replace("\\ \\ ", "\\ ")


class Page:
    def __init__(self, name):
        self.name, self.lines, self.paragraph, self.indent = name, [], [], ""

    def flush(self):
        if self.paragraph:
            self.lines += [self.indent + marked_up(self.paragraph).strip(), ""]
        self.paragraph = []

    def text(self, line):
        if self.paragraph:
            self.paragraph.append(("R", " "))
        self.paragraph += styled(line)

    def heading(self, title):
        self.flush()
        self.indent = ""
        self.lines += [title, "-" * len(title), ""]

    def tag(self, line):
        self.flush()
        label = plain(styled(line)).strip()
        if label.startswith("-"):
            self.lines += [".. option:: " + label, ""]
        else:
            self.lines.append(marked_up(styled(line)))
        self.indent = "   "


def parsed(path):
    """The page, its summary and synopsis."""
    name = "voxmend " + os.path.basename(path)[len("voxmend-"):-2]
    page, summary, synopsis, section, in_example = Page(name), "", "", "", False
    lines = iter(open(path, encoding="utf-8").read().splitlines())
    for line in lines:
        macro = line.split(" ")[0] if line.startswith(".") else ""
        if line.startswith('.\\"') or macro in (".TH", ".in"):
            continue
        if macro == ".SH":
            section = line[4:].strip('"')
            if section not in LEFT_OUT and section != "DESCRIPTION":
                page.heading(section.capitalize())
        elif section == "NAME":
            summary = plain(runs_of(line)).split(" - ", 1)[1]
        elif section == "SYNOPSIS":
            synopsis += " " + plain(styled(line))
        elif section in LEFT_OUT:
            continue
        elif macro == ".EX":
            page.flush()
            page.lines += [page.indent + "::", ""]
            in_example = True
        elif macro == ".EE":
            page.lines.append("")
            in_example = False
        elif in_example:
            page.lines.append(page.indent + "   " + plain(styled(line)))
        elif macro == ".TP":
            page.tag(next(lines))
        elif macro == ".PP":
            page.flush()
            page.indent = ""
        elif macro == ".br":
            page.flush()
        elif macro and not re.match(r"\.(BR|RB|IR|RI|B|I)$", macro):
            raise SystemExit("%s: the macro %s is not known" % (path, macro))
        else:
            page.text(line)
    page.flush()
    return page, summary, " ".join(synopsis.split())


def main():
    out, introduction, pages = sys.argv[1], sys.argv[2], sys.argv[3:]
    os.makedirs(out, exist_ok=True)
    index, names = open(introduction, encoding="utf-8").read() + "| command | does |\n|---|---|\n", []
    for path in pages:
        page, summary, synopsis = parsed(path)
        short = page.name.split()[1]
        with open(os.path.join(out, short + ".rst"), "w", encoding="utf-8") as file:
            file.write("\n".join([page.name, "=" * len(page.name), "", ".. program:: " + page.name, "", "::", "", "   " + synopsis, "",
                                  *page.lines]))
        index += "| [`%s`](%s.rst) | %s |\n" % (page.name, short, summary)
        names.append(short)
    index += "\n```{toctree}\n:hidden:\n\n%s\n```\n" % "\n".join(names)
    with open(os.path.join(out, "index.md"), "w", encoding="utf-8") as file:
        file.write(index)


main()
