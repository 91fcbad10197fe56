# SPDX-License-Identifier: BSD-3-Clause
"""Compiles the binding; everything else is in pyproject.toml."""
import sys

from setuptools import setup

# An archive of the sources, and what is told of the package, need neither the library nor its header.
compiles = not {"sdist", "egg_info", "dist_info"} & set(sys.argv[1:])
setup(cffi_modules=["build_voxmend.py:ffi"] if compiles else [])
