"""Paths as people write them: `~` stands for a home folder."""

from os import PathLike
from pathlib import Path
from typing import cast

from ..errors import ConfigError, quoted, wrong_argument


def as_path(value: object, name: str = "path") -> Path:
    """Return a value as a path; a leading `~` or `~user` becomes that user's home folder.

    name: the argument's name in messages.
    Raises: ArgumentError if the value is not a path, ConfigError if there is no such user.
    """
    if not isinstance(value, str | PathLike):
        raise wrong_argument(name, value, "a path")
    path = Path(cast("str | PathLike[str]", value))
    try:
        return path.expanduser()
    except RuntimeError as error:
        raise ConfigError(f"{path}: no user here is named {quoted(path.parts[0][1:])}, and `~` names a home") from error
