"""The folders of a set and the names of their files; no file is opened."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tangible_core.errors import PictureError

MOST_DEPTH = 10
"""The number of levels of folders that are searched; no kit has more than six."""
MOST_ENTRIES = 500_000
"""The number of names at which a search is refused, after some seconds; the largest kit has 60,000."""


class Folder(NamedTuple):
    """A folder with the names of its files."""

    path: Path
    within: tuple[str, ...]
    """The names of the folders from the first one to this one."""
    files: frozenset[str]

    def has(self, *names: str) -> bool:
        """Return True if all of these files are in the folder."""
        return self.files.issuperset(names)


def folders(root: Path) -> Iterator[Folder]:
    """Yield the folder and all folders in it, by name; links are followed, but no folder is listed twice.

    Raises: PictureError if a folder cannot be listed, or there are too many entries.
    """
    seen = set[tuple[int, int]]()
    waiting, count = [(str(root), (root.absolute().name,))], 0
    while waiting:
        path, within = waiting.pop()
        below, files = list[str](), list[str]()
        try:
            state = os.stat(path)  # noqa: PTH116 - pathlib would take most of the time
            if (state.st_dev, state.st_ino) in seen:
                continue
            seen.add((state.st_dev, state.st_ino))
            with os.scandir(path) as entries:
                for each in entries:
                    if each.is_dir():
                        below.append(each.name)
                    elif each.is_file():  # a broken link is not a file
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
