# SPDX-License-Identifier: BSD-3-Clause
"""Whether all links within a site lead somewhere: links.py FOLDER. Files and anchors have to be there; links to other sites are
listed, not followed. Nothing that a page loads may come from elsewhere."""
import os
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.anchors = [], [], {""}
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors.update(given[name] for name in ("id", "name") if given.get(name))
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        elif given.get("src"):
            self.loaded.append(given["src"])
        elif tag == "link" and given.get("href"):
            self.loaded.append(given["href"])


def main():
    root = os.path.abspath(sys.argv[1])
    pages = {}
    for at, _, names in os.walk(root):
        for name in names:
            if name.endswith(".html"):
                pages[os.path.join(at, name)] = Page(os.path.join(at, name))
    bad, elsewhere, count = [], set(), 0
    for path, page in sorted(pages.items()):
        shown = os.path.relpath(path, root)
        for link in page.links + page.loaded:
            url = urlsplit(link)
            if url.scheme == "mailto" or url.scheme == "data":
                continue
            if url.scheme or url.netloc:
                elsewhere.add(link)
                if link in page.loaded:
                    bad.append("%s loads %s" % (shown, link))
                continue
            count += 1
            target = os.path.normpath(os.path.join(os.path.dirname(path), unquote(url.path))) if url.path else path
            if not os.path.exists(target):
                bad.append("%s: %s is not there" % (shown, link))
            elif target in pages and unquote(url.fragment) not in pages[target].anchors:
                bad.append("%s: %s has no such place" % (shown, link))
    print("\n".join(sorted(elsewhere)))
    print("%d pages, %d links within, %d to other sites" % (len(pages), count, len(elsewhere)))
    for line in bad:
        print("FAILED:", line)
    sys.exit(bool(bad) or len(pages) < 40)


main()
