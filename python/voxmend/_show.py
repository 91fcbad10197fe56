# SPDX-License-Identifier: BSD-3-Clause
"""Grids and fields to be looked at: a page in a notebook or a browser."""
from __future__ import annotations

import html
import importlib
import os
import sys
import tempfile
import webbrowser
from typing import Any, Optional

from . import _core, _values
from ._core import ffi, lib
from ._errors import RangeError

# Notebooks keep what they show.
_NOTEBOOK_MOST = 8 << 20


def _in_notebook() -> bool:
    """Whether what is displayed is seen as HTML."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and hasattr(shell, "kernel")


class Shown:
    """What has a page."""

    _pointer: Any

    def save_page(self, path: Any, title: Optional[str] = None) -> None:
        """Writes a page (.html) that shows it in a browser with WebGL 2; one file, which needs no network."""
        options = _core.new("vxm_page_options")
        text = ffi.NULL if title is None else ffi.new("char[]", _values.word("save_page: title", title).encode())
        options.title = text
        place = _values.path(path)
        if ffi.typeof(self._pointer).item.cname.endswith("vxm_field"):
            _core.call(lib.vxm_field_page, self._pointer, place, options, ffi.NULL, path=path)
        else:
            _core.call(lib.vxm_grid_page, self._pointer, place, options, path=path)

    def _repr_html_(self) -> str:
        with tempfile.TemporaryDirectory(prefix="voxmend-") as folder:
            path = os.path.join(folder, "page.html")
            try:
                self.save_page(path, type(self).__name__)
            except RangeError:
                return "<pre>%s: too large for a page</pre>" % html.escape(repr(self))
            if os.path.getsize(path) > _NOTEBOOK_MOST:
                return "<pre>%s: too large for a notebook; save_page(path) writes a page</pre>" % html.escape(repr(self))
            with open(path, encoding="utf-8") as file:
                page = file.read()
        return '<iframe srcdoc="%s" style="width: 100%%; height: 480px; border: 1px solid #ccc"></iframe>' % html.escape(page)

    def show(self) -> Optional[str]:
        """Shows it in the notebook, or else in the browser: then gives the path of the page, which stays there."""
        if _in_notebook():
            notebook = importlib.import_module("IPython.display")
            notebook.display(notebook.HTML(self._repr_html_()))
            return None
        handle, path = tempfile.mkstemp(prefix="voxmend-", suffix=".html")
        os.close(handle)
        self.save_page(path, type(self).__name__)
        webbrowser.open("file://" + path)
        return path
