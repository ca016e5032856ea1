"""Paths as somebody writes them: `~` is a home, and what is no path is said."""

from os import PathLike
from pathlib import Path
from typing import cast

from ..errors import ConfigError, quoted, wrong_argument


def as_path(path: object, name: str = "path") -> Path:
    """A path whose `~` or `~user` at the beginning is that user's home.

    name: of the argument. Raises: ArgumentError for what is no path, ConfigError for a user that there is not.
    """
    if not isinstance(path, str | PathLike):
        raise wrong_argument(name, path, "a path")
    found = Path(cast("str | PathLike[str]", path))
    try:
        return found.expanduser()
    except RuntimeError as error:
        raise ConfigError(
            f"{found}: no user here is named {quoted(found.parts[0][1:])}, and `~` names a home"
        ) from error
