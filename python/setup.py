# SPDX-License-Identifier: BSD-3-Clause
"""Compiles the binding; everything else is in pyproject.toml."""
from setuptools import setup

setup(cffi_modules=["build_voxmend.py:ffi"])
