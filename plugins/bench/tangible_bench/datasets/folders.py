"""The folders of a set with the names of their files, and files whose patterns match the same; no file is opened."""

import os
import re
from collections.abc import Iterator, Mapping
from fnmatch import translate
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from tangible_core.errors import ConfigError, PictureError, quoted
from tangible_core.files import as_path

# The number of levels of folders that are searched; no kit has more than six.
MAX_DEPTH = 10
# The number of names at which a search is refused, after some seconds; the largest kit has 60,000.
MAX_ENTRIES = 500_000


class Folder(NamedTuple):
    """A folder with the names of its files."""

    path: Path
    within: tuple[str, ...]  # the names of the folders from the first one to this one
    files: frozenset[str]

    def has(self, *names: str) -> bool:
        """Return True if all of these files are in the folder."""
        return self.files.issuperset(names)


def folders(root: Path) -> Iterator[Folder]:
    """Yield the folder and all folders in it, by name; links are followed, each once. Raises: PictureError."""
    visited_inodes = set[tuple[int, int]]()
    waiting, count = [(str(root), (root.absolute().name,))], 0
    while waiting:
        path, within = waiting.pop()
        below, files = list[str](), list[str]()
        try:
            state = os.stat(path)  # noqa: PTH116 - pathlib would take most of the time
            if (state.st_dev, state.st_ino) in visited_inodes:  # links may form a ring
                continue
            visited_inodes.add((state.st_dev, state.st_ino))
            with os.scandir(path) as entries:
                for entry in entries:
                    if entry.is_dir():
                        below.append(entry.name)
                    elif entry.is_file():  # a broken link is not a file
                        files.append(entry.name)
        except OSError as error:
            raise PictureError(f"{path}: cannot be listed: {error.strerror}; check its permissions") from error
        count += len(below) + len(files)
        if count > MAX_ENTRIES:
            raise PictureError(f"{root}: holds more than {MAX_ENTRIES} files; name the folder of the set alone")
        yield Folder(Path(path), within, frozenset(files))
        if len(within) <= MAX_DEPTH:
            below.sort(reverse=True)
            waiting += [(os.path.join(path, name), (*within, name)) for name in below]  # noqa: PTH118


_WILD = re.compile(r"\*\*/?|\*|\?|\[[^\]]+\]")


def match_files(folder: Path, patterns: Mapping[str, str], required: tuple[str, str]) -> dict[str, dict[str, Path]]:
    """Return name -> part -> file, in the order of names; a name is the text that the stars match.

    patterns: part -> pattern relative to the folder, with `*`, `?` and `**/`. needed: the two parts that each name has.
    Raises: ConfigError for different numbers of stars; PictureError without a match or a partner.
    """
    first, second = required
    star_count = len(_WILD.findall(patterns[first]))
    for part, pattern in patterns.items():
        if (stars := len(_WILD.findall(pattern))) != star_count or not stars:
            raise ConfigError(
                f"{part}: {quoted(pattern)} has {stars} stars and {first}: {quoted(patterns[first])} has {star_count}; "
                "files belong together if their stars match the same, so each pattern needs as many, at least one"
            )
    files_of = {part: dict(_files(folder, pattern)) for part, pattern in patterns.items()}
    names = sorted(files_of[first])
    if not names:
        raise PictureError(f"{folder}: no file in it matches {first}: {quoted(patterns[first])}; check the pattern")
    if lonely := next((name for name in names if name not in files_of[second]), None):
        raise PictureError(
            f"{files_of[first][lonely]}: no file matches {second}: {quoted(patterns[second])} with the same stars "
            f"({quoted(lonely)}); correct the pattern, or move this one away"
        )
    return {name: {part: files[name] for part, files in files_of.items() if name in files} for name in names}


def _files(folder: Path, pattern: str) -> Iterator[tuple[str, Path]]:
    base, rest = _start(folder, pattern)
    if not base.is_dir():
        raise PictureError(f"{base}: there is no such folder for {quoted(pattern)}; check the path")
    expression = re.compile(_regex(rest))
    deep = "/" in rest or "**" in rest
    for place in folders(base):
        within = place.path.relative_to(base).as_posix()
        for name in sorted(place.files):
            hit = expression.fullmatch(name if within == "." else f"{within}/{name}")
            if hit is not None:
                yield "/".join(part.strip("/") for part in hit.groups() if part.strip("/")), place.path / name
        if not deep:
            break


def _start(folder: Path, pattern: str) -> tuple[Path, str]:
    """Return the folder before the first star, and the rest of the pattern."""
    parts = PurePosixPath(as_path(pattern).as_posix()).parts
    plain = next((index for index, part in enumerate(parts) if _WILD.search(part)), len(parts))
    return folder.joinpath(*parts[:plain]), "/".join(parts[plain:])


def _regex(pattern: str) -> str:
    """Return a regular expression with a group for each star.

    >>> _regex("**/left_*.png")
    '((?:[^/]+/)*)left_([^/]*)\\\\.png'
    """
    text, at = "", 0
    for star in _WILD.finditer(pattern):
        text += re.escape(pattern[at : star.start()]) + _STARS.get(star[0], "")
        text += "" if star[0] in _STARS else f"({_bracket_expression(star[0])})"
        at = star.end()
    return text + re.escape(pattern[at:])


_STARS = {"**/": "((?:[^/]+/)*)", "**": "(.*)", "*": "([^/]*)", "?": "([^/])"}


def _bracket_expression(brackets: str) -> str:
    """Return brackets such as `[0-9]` as a regular expression."""
    return translate(brackets).removeprefix("(?s:").removesuffix(r")\Z").removesuffix(r")\z")
