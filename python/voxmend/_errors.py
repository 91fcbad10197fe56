# SPDX-License-Identifier: BSD-3-Clause
"""What failures and warnings look like: one family of exceptions, each a kind that Python knows too."""
from __future__ import annotations

import errno
import os
from typing import Any


class VoxmendError(Exception):
    """A call that failed, with one line of text.

    Attributes:
        status: short fixed name of the failure, such as "format"; "" where the library was not called.
        file: file concerned, or "".
        line: line in a text file, or 0.
        offset: byte in a binary file, or -1.
        element: vertex, face or record, or -1.
    """

    status: str = ""
    file: str = ""
    line: int = 0
    offset: int = -1
    element: int = -1


class ArgumentError(VoxmendError, ValueError):
    """An argument is out of its range."""


class KindError(VoxmendError, TypeError):
    """An argument is of a wrong kind: 1.5 or True as a number of voxels, complex coordinates, an array of objects."""


class FileError(VoxmendError, OSError):
    """The system refused to open, read, write or rename.

    Attributes:
        errno: the system's number, or None; the commonest have classes of their own, which are Python's too.
        filename: as the caller named it.
    """

    text: str = ""

    def __str__(self) -> str:
        return self.text or OSError.__str__(self)


class FileMissingError(FileError, FileNotFoundError):
    """There is no such file or folder."""


class FileRightsError(FileError, PermissionError):
    """The user has no right to do it."""


class FileIsFolderError(FileError, IsADirectoryError):
    """A folder stands where a file is wanted."""


class FileNoFolderError(FileError, NotADirectoryError):
    """A file stands where a folder is wanted."""


class FileThereError(FileError, FileExistsError):
    """Something is there already."""


class FormatError(VoxmendError, ValueError):
    """The content is not a known format, or is damaged beyond reading."""


class NumbersError(FormatError):
    """The file holds numbers, not set and clear voxels: `voxmend.read_field` reads them."""


class EmptyError(VoxmendError, ValueError):
    """There is nothing to work on."""


class OutOfMemoryError(VoxmendError, MemoryError):
    """The system has no memory left, or the limit would be exceeded."""


class RangeError(VoxmendError, ValueError):
    """A size or coordinate is beyond what can be computed."""


class UnavailableError(VoxmendError, NotImplementedError):
    """The library was built without what this needs."""


class UnreachedError(VoxmendError, RuntimeError):
    """A repair did not come as far as it was asked to."""


class CancelledError(VoxmendError):
    """The call was told to stop, as its result is no longer wanted."""


class VoxmendTimeout(CancelledError, TimeoutError):
    """A call took longer than the `timeout` that it was given; nothing was made."""


class BusyError(VoxmendError, RuntimeError):
    """An object was asked for something by a call of its own: by a handler of signals, for one."""


class VoxmendWarning(UserWarning):
    """What the command line tells as a warning: damage in a file, a part that sets no voxel, ..."""


_of_errno = {
    errno.ENOENT: FileMissingError,
    errno.EACCES: FileRightsError,
    errno.EPERM: FileRightsError,
    errno.EISDIR: FileIsFolderError,
    errno.ENOTDIR: FileNoFolderError,
    errno.EEXIST: FileThereError,
}


def file_error(message: str, number: int, file: bytes, path: Any) -> FileError:
    """As OSError: with errno, its text and the file's name, which is the caller's own unless another file is concerned."""
    if path is not None and os.fsencode(path).endswith(file):  # the library shortens long names at the front
        name = os.fspath(path)
    else:
        name = os.fsdecode(file)
    made = _of_errno.get(number, FileError)(number, os.strerror(number), name) if number else FileError(message)
    made.text = message
    return made
