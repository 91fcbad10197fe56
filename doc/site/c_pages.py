# SPDX-License-Identifier: BSD-3-Clause
"""A page for each public header, in the order of the header, of what Doxygen found: c_pages.py OUTPUT INTRODUCTION.md XML SOURCE
The directives are Breathe's, which fills in the comments."""
import os
import re
import sys
from xml.etree import ElementTree

# In the order in which they are read.
HEADERS = ("base", "mesh", "repair", "grid", "voxelize", "field", "sparse", "carve", "sampler", "engine", "experimental")
DIRECTIVES = {"function": "doxygenfunction", "define": "doxygendefine", "typedef": "doxygentypedef", "enum": "doxygenenum"}


def text_of(node):
    return " ".join("".join(node.itertext()).split()) if node is not None else ""


def described(node):
    return bool(text_of(node.find("briefdescription")) or text_of(node.find("detaileddescription")))


def file_compounds(xml):
    index = ElementTree.parse(os.path.join(xml, "index.xml")).getroot()
    for compound in index.iter("compound"):
        if compound.get("kind") == "file":
            root = ElementTree.parse(os.path.join(xml, compound.get("refid") + ".xml")).getroot().find("compounddef")
            yield root.find("location").get("file"), root


def name_unnamed(xml, source):
    """Members of a structure without a name within another one, which Doxygen lists beside those of that: `passes.count`."""
    for file in sorted(os.listdir(xml)):
        if not file.startswith("struct"):
            continue
        path = os.path.join(xml, file)
        tree = ElementTree.parse(path)
        members = list(tree.getroot().iter("memberdef"))
        outer = [member for member in members if "::@" in text_of(member.find("type"))]
        for array in outer:
            location, name = array.find("location"), array.findtext("name")
            last = int(location.get("line"))
            with open(os.path.join(source, location.get("file")), encoding="utf-8") as header:
                lines = header.read().splitlines()[:last]
            first = last - lines[::-1].index("  struct {")
            for member in members:
                if first <= int(member.find("location").get("line")) < last:
                    member.find("name").text = name + "." + member.findtext("name")
            array.find("type").clear()
            array.find("type").text = "struct unnamed"
        if outer:
            tree.write(path, encoding="utf-8")


def link_names(xml):
    """Names of the library within descriptions become links; Doxygen links functions only where "()" stands behind them."""
    targets = {}
    for compound in ElementTree.parse(os.path.join(xml, "index.xml")).getroot().iter("compound"):
        if compound.get("kind") == "struct":
            targets[compound.findtext("name")] = compound.get("refid"), "compound"
        for member in compound.iter("member"):
            if compound.get("kind") == "file":
                targets.setdefault(member.findtext("name"), (member.get("refid"), "member"))

    def split(text):
        """The text before the first link, and links with the text behind each."""
        parts, links = re.split(r"\b((?:vxm|VXM)_\w+)", text or ""), []
        before = parts[0]
        for name, after in zip(parts[1::2], parts[2::2]):
            if name in targets:
                link = ElementTree.Element("ref", refid=targets[name][0], kindref=targets[name][1])
                link.text, link.tail = name, after
                links.append(link)
            elif links:
                links[-1].tail += name + after
            else:
                before += name + after
        return before, links

    def walk(node):
        if node.tag in ("ref", "computeroutput", "programlisting"):
            return
        children = list(node)
        node.text, links = split(node.text)
        for child in children:
            walk(child)
            child.tail, more = split(child.tail)
            links += [child, *more]
        node[:] = links

    for file in sorted(os.listdir(xml)):
        if file.endswith(".xml") and file != "index.xml":
            tree = ElementTree.parse(os.path.join(xml, file))
            for tag in ("briefdescription", "detaileddescription"):
                for description in tree.getroot().iter(tag):
                    walk(description)
            tree.write(os.path.join(xml, file), encoding="utf-8")


def items_of(root, xml):
    """(line, directive) of all that the header declares."""
    for member in root.iter("memberdef"):
        if described(member) and member.get("kind") in DIRECTIVES:
            yield int(member.find("location").get("line")), "%s:: %s" % (DIRECTIVES[member.get("kind")], member.findtext("name"))
    for inner in root.findall("innerclass"):
        struct = ElementTree.parse(os.path.join(xml, inner.get("refid") + ".xml")).getroot().find("compounddef")
        if described(struct) and "." not in inner.text:
            yield int(struct.find("location").get("line")), "doxygenstruct:: %s\n   :members:\n   :undoc-members:" % inner.text


def headings_of(path):
    with open(path, encoding="utf-8") as file:
        for line, text in enumerate(file, 1):
            found = re.match(r"/\* ---- (.*) ---- \*/", text)
            if found:
                yield line, found[1]


def main():
    out, introduction, xml, source = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    name_unnamed(xml, source)
    link_names(xml)
    compounds = {name: root for name, root in file_compounds(xml)}
    index = open(introduction, encoding="utf-8").read()
    for header in HEADERS:
        name = "voxmend/%s.h" % header
        root = next(root for path, root in compounds.items() if path.endswith(name))
        lines = [".. _%s:" % root.get("id"), "", name, "=" * len(name), "", ".. doxygenfile:: %s" % name, "   :sections: briefdescription detaileddescription", ""]
        headings = dict(headings_of(os.path.join(source, name)))
        items = sorted(items_of(root, xml))
        for line in sorted([*headings, *(line for line, _ in items)]):
            if line in headings:
                lines += [headings[line], "-" * len(headings[line]), ""]
            lines += [".. %s\n" % directive for at, directive in items if at == line]
        with open(os.path.join(out, header + ".rst"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines))
        index += "| [`%s`](%s.rst) | %s |\n" % (name, header, text_of(root.find("briefdescription")) or text_of(root.find("detaileddescription")))
    with open(os.path.join(out, "index.md"), "w", encoding="utf-8") as file:
        file.write(index + "\n```{toctree}\n:hidden:\n\n%s\n```\n" % "\n".join(HEADERS))


main()
