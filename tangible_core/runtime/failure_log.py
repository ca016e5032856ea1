"""The log of tracebacks: the user gets one sentence with the path of this file, for the person who repairs it."""

import os
import shlex
import sys
import traceback
from datetime import datetime
from functools import partial
from pathlib import Path

from ..errors import OutputError

NAME, OLDER = "failures.log", "failures.old.log"
MAX_BYTES = 1_000_000
"""The size from which the log is rotated to the older file."""


def log_folder() -> Path:
    """Return $TANGIBLE_LOG_DIR, or the user's folder for logs."""
    if folder := os.environ.get("TANGIBLE_LOG_DIR"):
        return Path(os.path.expanduser(folder))  # noqa: PTH111 - pathlib raises for an unknown home
    from platformdirs import user_log_path

    return user_log_path("tangible-images")


def keep(error: BaseException) -> Path:
    """Append an error's traceback with the time and the command, and return the file, which is this user's alone."""
    path = log_folder() / NAME
    when = datetime.now().astimezone().isoformat(timespec="seconds")
    text = f"{when} {shlex.join(sys.argv)}\n{''.join(traceback.format_exception(error))}\n"
    try:
        path.parent.mkdir(0o700, parents=True, exist_ok=True)
        if path.exists() and path.stat().st_size > MAX_BYTES:
            path.replace(path.with_name(OLDER))
        private = partial(os.open, mode=0o600)
        with open(path, "a", encoding="utf-8", errors="backslashreplace", opener=private) as file:
            file.write(text)
    except OSError as failed:
        raise OutputError(f"{path}: cannot be written: {failed.strerror}") from failed
    return path


def where_kept(error: BaseException) -> str:
    """Keep a traceback, and return where it is, as the end of a sentence.

    >>> where_kept(ValueError()).startswith("the traceback is in ")
    True
    """
    try:
        return f"the traceback is in {keep(error)}"
    except OutputError as failed:
        return f"its traceback could not be kept ({failed}); --log-level debug shows it"
