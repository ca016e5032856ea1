"""A folder of a set with all that is in it, by names alone: no file is opened."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tangible_core.errors import PictureError

MOST_DEPTH = 10
"""Folders in folders; no kit has more than six."""
MOST_ENTRIES = 500_000
"""Names, which take some seconds; the largest kit has 60,000."""


class Folder(NamedTuple):
    """A folder, and the files in it."""

    path: Path
    within: tuple[str, ...]
    """Its name, after those of the folders that it lies in, from the first one on."""
    files: frozenset[str]

    def has(self, *names: str) -> bool:
        """Whether all of these files are in it."""
        return self.files.issuperset(names)


def folders(root: Path) -> Iterator[Folder]:
    """The folder and all folders in it, by name; links are followed, but into no folder twice.

    Raises: PictureError if one cannot be listed, or there are too many entries.
    """
    seen = set[tuple[int, int]]()
    waiting, count = [(str(root), (root.absolute().name,))], 0
    while waiting:
        path, within = waiting.pop()
        below, files = list[str](), list[str]()
        try:
            found = os.stat(path)  # noqa: PTH116 - pathlib would take most of the time
            if (found.st_dev, found.st_ino) in seen:
                continue
            seen.add((found.st_dev, found.st_ino))
            with os.scandir(path) as entries:
                for each in entries:
                    if each.is_dir():
                        below.append(each.name)
                    elif each.is_file():  # a link to nothing is none
                        files.append(each.name)
        except OSError as error:
            raise PictureError(f"{path}: cannot be listed: {error.strerror}; check its permissions") from error
        count += len(below) + len(files)
        if count > MOST_ENTRIES:
            raise PictureError(f"{root}: holds more than {MOST_ENTRIES} files; name the folder of the set alone")
        yield Folder(Path(path), within, frozenset(files))
        if len(within) <= MOST_DEPTH:
            below.sort(reverse=True)
            waiting += [(os.path.join(path, name), (*within, name)) for name in below]  # noqa: PTH118
