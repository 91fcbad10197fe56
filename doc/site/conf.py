# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings for the site. doc/site/build lays out what it reads, and tells the version."""
import os

project = "voxmend"
author = "voxmend authors"
copyright = author
version = release = os.environ["VOXMEND_VERSION"]

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
nitpicky = True
highlight_language = "text"

# ---- Markdown ----
myst_heading_anchors = 4  # links to headings, as code hosts make them
myst_enable_extensions = ["deflist"]

# ---- C: of Doxygen's XML ----
breathe_projects = {"voxmend": os.environ["VOXMEND_XML"]}
breathe_default_project = "voxmend"
breathe_domain_by_extension = {"h": "c"}
c_id_attributes = ["VXM_API"]
nitpick_ignore = [("c:identifier", name) for name in (
    "bool", "size_t", "int64_t", "uint8_t", "uint16_t", "uint32_t", "uint64_t", "DLManagedTensor", "unnamed")]

# ---- Python: of the package that was built ----
autodoc_mock_imports = ["torch"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_type_aliases = {name: name for name in ("ArrayLike", "EngineLike", "Like", "MeshLike", "Path", "Progress", "Resolution", "Size")}
toc_object_entries_show_parents = "hide"
autodoc_default_options = {"members": True, "undoc-members": False}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
default_role = "code"
# Aliases of types, and types of other packages.
nitpick_ignore_regex = [("py:.*", r"(?!voxmend).*"), ("py:.*", r"voxmend\._.*")]

# ---- The look ----
html_theme = "furo"
html_title = "voxmend " + version
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
pygments_style = "friendly"
pygments_dark_style = "native"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#9a4a12", "color-brand-content": "#9a4a12"},
    "dark_css_variables": {"color-brand-primary": "#f0a868", "color-brand-content": "#f0a868"},
}
