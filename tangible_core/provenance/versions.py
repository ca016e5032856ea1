"""Versions of the libraries below the code, and the list of libraries that change results."""

import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import metadata, util
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import NamedTuple

_OPENCV = ("opencv-contrib-python-headless", "opencv-contrib-python", "opencv-python-headless", "opencv-python")

# The libraries that compute results: import name -> the distributions that it may come in, and those below it.
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

# Further distributions named unlike their import; looking one up takes a fifth of a second.
_OTHERS: Mapping[str, tuple[str, ...]] = {"ruamel": ("ruamel.yaml",), "usb": ("pyusb",)}

_VERSION = re.compile(r"^Version:\s*(\S+)", re.MULTILINE)


def versions(*more: str) -> dict[str, str]:
    """Return the versions of Python, Tangible Images, LIBRARIES and more distributions, as far as installed."""
    return _find_versions(["tangible-images", *(name for names in LIBRARIES.values() for name in names), *more])


def of_imported(tops: Iterable[str]) -> dict[str, str]:
    """Return the versions of Python and of the distributions of these top packages, listed here or not."""
    return _find_versions([name for top in sorted(tops) for name in _distributions(top)])


def is_plugin(top: str) -> bool:
    """Return True if the distribution of a package has plugins of Tangible Images."""
    distributions = (metadata.distribution(name) for name in _distributions(top) if _version(name))
    return any(point.group.startswith("tangible.") for package in distributions for point in package.entry_points)


def _find_versions(distributions: Iterable[str]) -> dict[str, str]:
    python = {"python": ".".join(map(str, sys.version_info[:3]))}
    return python | {name: version for name in dict.fromkeys(distributions) if (version := _version(name))}


@cache
def _distributions(top: str) -> tuple[str, ...]:
    if top in sys.stdlib_module_names:
        return ()
    if names := LIBRARIES.get(top) or _OTHERS.get(top):
        return names
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


# The folders of installed packages, whose source does not change between versions.
INSTALLED = {"site-packages", "dist-packages"}

HOME = __name__.partition(".")[0]


class Place(NamedTuple):
    """A module, its file, and the package where its relative imports start."""

    name: str
    file: str
    package: str

    @property
    def is_package(self) -> bool:
        """True for a package."""
        return self.name == self.package

    @property
    def top(self) -> str:
        """The top package of the module, or the module itself."""
        return (self.package or self.name).partition(".")[0]


@cache
def place(name: str) -> Place | None:
    """Return the module of this name, as it was or would be imported; None if it is not a module."""
    module = sys.modules.get(name)
    file, package = (getattr(module, attribute, None) for attribute in ("__file__", "__package__"))
    if isinstance(file, str):
        return Place(name, file, package or "")
    spec = _spec(name)
    if spec is None or not spec.has_location or spec.origin is None:
        return None
    return Place(name, spec.origin, spec.parent or "")


@cache
def is_read(top: str) -> bool:
    """Return True if the source of a top package is read: that of Tangible Images, and code that may be edited."""
    if top in sys.stdlib_module_names or top in LIBRARIES:
        return False
    if top == HOME:
        return True
    spec = _spec(top)
    where = [] if spec is None else [*(spec.submodule_search_locations or ()), spec.origin or ""]
    return not any(INSTALLED & set(Path(path).parts) for path in where) or is_plugin(top)


@cache
def _spec(name: str) -> ModuleSpec | None:
    """Find how a module would be imported; unlike `find_spec`, without importing the packages above it."""
    above = name.rpartition(".")[0]
    if not above:
        try:
            return util.find_spec(name)
        except ValueError:  # a module without a spec, such as `__main__`
            return None
    parent = _spec(above)
    if parent is None or parent.submodule_search_locations is None:
        return None
    return PathFinder.find_spec(name, list(parent.submodule_search_locations))
