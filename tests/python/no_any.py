# SPDX-License-Identifier: BSD-3-Clause
"""Every public function, method and property says what it returns, and that is nothing of cffi: Any only where another package's
object is returned."""
import inspect
import typing

import voxmend

FOREIGN = {"to_trimesh", "to_open3d", "to_pyvista", "to_meshio", "__dlpack__", "__getitem__", "get", "items", "values"}
bad = []


def look(name, function):
    for at, kind in function.__annotations__.items():
        if kind in ("Any", typing.Any) and at == "return" and name.rsplit(".", 1)[-1] not in FOREIGN:
            bad.append("%s returns Any" % name)
        if "CData" in str(kind):
            bad.append("%s: %s is of cffi" % (name, at))
    missing = [p for p in inspect.signature(function).parameters if p not in function.__annotations__ and p not in ("self", "cls")]
    if missing or "return" not in function.__annotations__ and not name.endswith("__init__"):
        bad.append("%s has no types for %s" % (name, ", ".join(missing) or "what it returns"))


count = 0
for name in voxmend.__all__:
    thing = getattr(voxmend, name)
    if inspect.isfunction(thing):
        look(name, inspect.unwrap(thing))
        count += 1
    if not inspect.isclass(thing):
        continue
    for member, value in vars(thing).items():
        value = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
        if hasattr(value, "__wrapped__"):  # dataclasses made it
            continue
        if inspect.isfunction(value) and (not member.startswith("_") or member.startswith("__")) and value.__module__.startswith("voxmend") \
                and value.__qualname__.split(".")[0] == name and "<string>" not in value.__code__.co_filename:
            look(name + "." + member, value)
            count += 1
print("%d functions" % count)
assert count > 130, count
assert not bad, "\n".join(bad)
