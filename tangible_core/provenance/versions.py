"""Versions of the libraries below the code, and the list of libraries that change results."""

import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import metadata

_OPENCV = ("opencv-contrib-python-headless", "opencv-contrib-python", "opencv-python-headless", "opencv-python")

LIBRARIES: Mapping[str, tuple[str, ...]] = {
    "numpy": ("numpy",),
    "scipy": ("scipy", "numpy"),
    "cv2": _OPENCV,
    "skimage": ("scikit-image", "scipy", "numpy"),
    "PIL": ("pillow",),
    "numba": ("numba", "llvmlite", "numpy"),
    "llvmlite": ("llvmlite",),
    "torch": ("torch",),
    "kornia": ("kornia", "torch"),
}
"""The libraries that compute results: import name -> the distributions that it may come in, and those below it."""

_OTHERS: Mapping[str, tuple[str, ...]] = {"ruamel": ("ruamel.yaml",), "usb": ("pyusb",)}
"""Further distributions named unlike their import; looking one up takes a fifth of a second."""

_VERSION = re.compile(r"^Version:\s*(\S+)", re.MULTILINE)


def versions(*more: str) -> dict[str, str]:
    """Return the versions of Python, Tangible Images, LIBRARIES and more distributions, as far as installed."""
    return _of(["tangible-images", *(name for names in LIBRARIES.values() for name in names), *more])


def of_imported(tops: Iterable[str]) -> dict[str, str]:
    """Return the versions of Python and of the distributions of these top packages, listed here or not."""
    return _of([name for top in sorted(tops) for name in _distributions(top)])


def is_plugin(top: str) -> bool:
    """Return True if the distribution of a package has plugins of Tangible Images."""
    installed = (metadata.distribution(name) for name in _distributions(top) if _version(name))
    return any(point.group.startswith("tangible.") for each in installed for point in each.entry_points)


def _of(distributions: Iterable[str]) -> dict[str, str]:
    python = {"python": ".".join(map(str, sys.version_info[:3]))}
    return python | {name: version for name in dict.fromkeys(distributions) if (version := _version(name))}


@cache
def _distributions(top: str) -> tuple[str, ...]:
    if top in sys.stdlib_module_names:
        return ()
    if listed := LIBRARIES.get(top) or _OTHERS.get(top):
        return listed
    if _version(top):
        return (top,)
    return tuple(sorted(set(metadata.packages_distributions().get(top, ()))))


@cache
def _version(distribution: str) -> str | None:
    """Return a version as `importlib.metadata.version`, without parsing the whole e-mail: in a tenth of the time."""
    try:
        text = metadata.distribution(distribution).read_text("METADATA")
    except metadata.PackageNotFoundError:
        return None
    match = _VERSION.search(text or "")
    return match[1] if match else metadata.version(distribution)
