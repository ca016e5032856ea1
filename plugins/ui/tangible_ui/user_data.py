"""Folders of the user's own files: recordings, drafts, what pages opened."""

import os
from pathlib import Path

from tangible_core.files import as_path

RECORDINGS = "recordings"


def user_folder(name: str) -> Path:
    """Return the folder of this user's data of one kind: below $TANGIBLE_DATA_DIR, or the system's folder."""
    if folder := os.environ.get("TANGIBLE_DATA_DIR"):
        return as_path(folder, "TANGIBLE_DATA_DIR") / name
    from platformdirs import user_data_path

    return user_data_path("tangible-images") / name
