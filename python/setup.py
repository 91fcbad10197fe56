# SPDX-License-Identifier: BSD-3-Clause
"""Compiles the binding, and the library with it where its sources are here; everything else is in pyproject.toml."""
import os
import sys
import sysconfig

import setuptools
from setuptools.command.build_ext import build_ext

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import build_library


class build_with_library(build_ext):
    """First the library, as the extension is linked with it."""

    def run(self):
        build_library.build()
        super().run()
        build_library.place(os.path.dirname(os.path.abspath(self.get_ext_fullpath("voxmend._voxmend"))))


# An archive of the sources, and what is told of the package, need neither the library nor its header.
compiles = not {"sdist", "egg_info", "dist_info"} & set(sys.argv[1:])
arguments = {"cffi_modules": ["build_voxmend.py:ffi"]} if compiles else {}
if build_library.is_packed():
    arguments.update(cmdclass={"build_ext": build_with_library}, scripts=build_library.PROGRAMS,
                     data_files=[("share/man/man1", [build_library.manual()])])
# One binary for all versions of CPython from 3.9 on; where threads run freely there is none yet.
if sys.implementation.name == "cpython" and not sysconfig.get_config_var("Py_GIL_DISABLED"):
    arguments["options"] = {"bdist_wheel": {"py_limited_api": "cp39"}}
# setuptools before 77 has no field for expressions.
arguments["license_expression" if int(setuptools.__version__.split(".")[0]) >= 77 else "license"] = "BSD-3-Clause"
setuptools.setup(**arguments)
