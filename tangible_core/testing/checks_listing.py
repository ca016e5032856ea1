"""Checks of an installed method before it is used: its name, its one line, the cost of importing it."""

import re
import subprocess

from ..plugins.registry import Listing
from ..runtime.child_process import python
from .checks import Check, demand

HEAVY = ("torch", "kornia", "cv2", "skimage", "numba", "usb", "scipy", "matplotlib")
"""Packages that take longer to import than a listing may last."""


def name_is_plain(listing: Listing) -> None:
    """The name is lower-case words joined by hyphens: it is typed in YAML and at the command line."""
    word = r"([a-z]|[1-9][a-z]{2})[a-z0-9]*"  # a file format may be called 3mf; 1e3 and 0xff are numbers in YAML
    demand(
        re.fullmatch(rf"{word}(-[a-z0-9]+)*", listing.name),
        f"the name is {listing.name!r}; write it as lower-case words joined by hyphens",
    )


def summary_is_there(listing: Listing) -> None:
    """The class has a docstring whose first line tells, in `tangible plugins`, what the method does."""
    demand(
        listing.summary and not listing.summary.startswith("("),
        f"no summary can be read for {listing.target}: {listing.summary or 'the first line is empty'}",
    )
    demand(len(listing.summary) <= 120, f"the summary is {len(listing.summary)} characters long; 120 fit a line")


def import_is_light(listing: Listing) -> None:
    """Importing the class's module pulls in nothing heavy: planning imports it, and only running may take time."""
    module = listing.point.module
    code = f"import {module}; print(*(name for name in {HEAVY} if name in sys.modules))"
    ran = subprocess.run(python(code), capture_output=True, text=True, check=False)
    demand(ran.returncode == 0, f"{module} cannot be imported: {(ran.stderr.strip() or '?').splitlines()[-1]}")
    demand(
        not ran.stdout.split(),
        f"importing {module} imports {', '.join(ran.stdout.split())}; import these inside the function that needs them",
    )


CHECKS: tuple[Check, ...] = (name_is_plain, summary_is_there, import_is_light)
