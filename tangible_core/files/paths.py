"""Paths as people write them: `~` stands for a home folder."""

import re
from collections.abc import Iterable
from os import PathLike, fsencode
from pathlib import Path
from typing import cast

from ..errors import ConfigError, did_you_mean, quoted, shown, wrong_argument

# Characters that a line of text, or an XML file, cannot have: controls, line breaks, halves of characters.
CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufffe\uffff]")
# The most bytes of a file's name; every common file system allows as many and no more.
MAX_NAME_BYTES = 255

# The most bytes of a path on Linux; other systems allow fewer, and then their own message is shown.
MAX_PATH_BYTES = 4095


def as_path(value: object, name: str = "path") -> Path:
    """Return a value as a path; a leading `~` or `~user` becomes that user's home folder, unless a file has it.

    name: the argument's name in messages.
    Raises: ArgumentError if the value is not a path; ConfigError if there is no such user, or if no file can have the
    name, so that nobody has to catch what the system says of it.
    """
    if not isinstance(value, str | PathLike):
        raise wrong_argument(name, value, "a path")
    path = Path(cast("str | PathLike[str]", value))
    _check_name(path)
    try:
        return path.expanduser()
    except RuntimeError as error:
        if path.exists() or (len(path.parts) == 1 and path.suffix):  # the name of a file, such as ~.png
            return path
        raise ConfigError(f"{path}: no user here is named {quoted(path.parts[0][1:])}, and `~` names a home") from error


def what_is_missing(path: Path, names: Iterable[str], what: str = "file") -> str:
    """Return why there is nothing at a path, and what to do; names: those of the files that may be meant."""
    if path.is_symlink():
        return f"is a link to {shown(str(path.readlink()))}, which is not there; restore that file, or name another one"
    return f"there is no such {what}{did_you_mean(path.name, names)}"


# Names that the left views of all pairs have, and those of the right ones next to them.
LEFT, RIGHT = ("left", "l", "im0", "im2", "view0", "view1"), ("right", "r", "im1", "im6", "view1", "view5")


def without_folders(name: str) -> str:
    """Return the name of a scene for people to read: that of the file, without its folders, or that of a pair's folder.

    >>> without_folders("/home/me/photo.jpg"), without_folders("builtin/brick")
    ('photo.jpg', 'builtin/brick')
    """
    path = Path(name)
    is_left = path.stem.casefold() in LEFT and path.parent.name
    if is_left and any(other.stem.casefold() in RIGHT for other in path.parent.glob("*")):
        return plain_line(path.parent.name)
    return plain_line(path.name if path.is_absolute() else name)


def plain_line(name: str) -> str:
    """Return the name of a file as one line of text: without line breaks, control characters, and bytes of no letter.

    >>> plain_line("two\\nlines\\udce9.png")
    'two lines .png'
    """
    return CONTROLS.sub(" ", name)


def _check_name(path: Path) -> None:
    try:
        sizes = [len(fsencode(part)) for part in path.parts]
    except UnicodeEncodeError:  # half a character, which JSON can express
        sizes = []
    if "\0" in str(path) or (path.parts and not sizes):
        raise ConfigError(f"{quoted(str(path))}: no file can have this name; use letters, digits and other characters")
    if max(sizes, default=0) > MAX_NAME_BYTES:
        raise ConfigError(f"{quoted(str(path))}: a file's name has at most {MAX_NAME_BYTES} bytes; use a shorter one")
    if len(fsencode(path)) > MAX_PATH_BYTES:
        raise ConfigError(f"{quoted(str(path))}: a path has at most {MAX_PATH_BYTES} bytes; use fewer folders")
