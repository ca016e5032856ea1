"""What a measurement depends on beside its method's options: code, versions, machine."""

import ast
import hashlib
import os
import platform
import re
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec, resolve_name
from pathlib import Path

PACKAGES = (
    "tangible-images", "numpy", "opencv-contrib-python-headless", "scikit-image", "scipy", "numba", "llvmlite",
    "pillow", "torch", "kornia",
)  # fmt: skip
"""Distributions whose version may change a result or its time."""


def versions(*more: str) -> dict[str, str]:
    """Version of Python and of each of PACKAGES and `more` that is installed."""
    found = {"python": platform.python_version()}
    for name in (*PACKAGES, *more):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


@cache
def machine() -> dict[str, str | int]:
    """Processor, how many of its cores this process may use, and system."""
    return {"processor": _processor(), "cores": _cores(), "system": f"{platform.system()} {platform.machine()}"}


@cache
def code_digest(module: str) -> str:
    """SHA-256 of the source of a module, and of every module of its own package that it imports, however deep.

    So a row is measured again when a kernel that a method calls has changed, and not when its neighbour has. Imports
    are read from the source text: nothing runs.
    """
    sources: dict[str, bytes] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = _source(name)
        if name in sources or path is None:
            continue
        sources[name] = path.read_bytes()
        waiting += _imports(sources[name], name, path)
    state = hashlib.sha256()
    for name in sorted(sources):
        state.update(name.encode() + b"\0" + sources[name] + b"\0")
    return state.hexdigest()[:16]


def _imports(source: bytes, name: str, path: Path) -> list[str]:
    """Modules of the same top package that a source text names, packages and what is taken from them alike."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    top = name.partition(".")[0]
    found: list[str] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [each.name for each in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = resolve_name("." * node.level + (node.module or ""), package) if node.level else node.module or ""
            found += [base, *(f"{base}.{each.name}" for each in node.names)]
    return [each for each in found if each.partition(".")[0] == top]


def _source(module: str) -> Path | None:
    """The file of a module; None if there is none, such as for a name that is a function."""
    top, *rest = module.split(".")
    spec = find_spec(top)
    if spec is None:
        return None
    if not spec.submodule_search_locations:
        return Path(spec.origin) if spec.origin and not rest and Path(spec.origin).suffix == ".py" else None
    place = Path(next(iter(spec.submodule_search_locations))).joinpath(*rest)
    candidates = (place / "__init__.py", place.with_name(f"{place.name}.py"))
    return next((each for each in candidates if each.is_file()), None)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _processor() -> str:
    try:
        found = re.search(r"model name\s*: (.+)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    except OSError:
        found = None
    return found[1] if found else platform.processor() or platform.machine()
