"""Versions of what code stands on, and the one list of libraries that change results."""

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
"""What computes results, by the name that is imported: the distributions that it may come in, and those below it."""

_OTHERS: Mapping[str, tuple[str, ...]] = {"ruamel": ("ruamel.yaml",), "usb": ("pyusb",)}
"""More that are not named as they are imported; looking one up takes a fifth of a second."""

_VERSION = re.compile(r"^Version:\s*(\S+)", re.MULTILINE)


def versions(*more: str) -> dict[str, str]:
    """Version of Python, of Tangible Images, of LIBRARIES, and of more distributions; of those that are installed."""
    return _of(["tangible-images", *(name for names in LIBRARIES.values() for name in names), *more])


def of_imported(tops: Iterable[str]) -> dict[str, str]:
    """Version of Python, and of what these top packages come in. One that is not in any list counts as well."""
    return _of([name for top in sorted(tops) for name in _distributions(top)])


def is_plugin(top: str) -> bool:
    """Whether a package comes in a distribution that has plugins of Tangible Images."""
    found = (metadata.distribution(name) for name in _distributions(top) if _version(name))
    return any(point.group.startswith("tangible.") for each in found for point in each.entry_points)


def _of(distributions: Iterable[str]) -> dict[str, str]:
    found = {"python": ".".join(map(str, sys.version_info[:3]))}
    return found | {name: its for name in dict.fromkeys(distributions) if (its := _version(name))}


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
    """As `importlib.metadata.version`, without reading the whole description as an e-mail: in a tenth of the time."""
    try:
        text = metadata.distribution(distribution).read_text("METADATA")
    except metadata.PackageNotFoundError:
        return None
    found = _VERSION.search(text or "")
    return found[1] if found else metadata.version(distribution)
