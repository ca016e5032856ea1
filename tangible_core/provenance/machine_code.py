"""Machine code of kernels that came with the wheel of a platform, so that a first run compiles nothing.

`MACHINE_CODE` is a folder that `deploy/platform_wheel.py` makes and nobody writes to afterwards. A kernel is loaded
from it if the text of its import closure is the same, numba and llvmlite have the same version and NumPy the same minor
version, the processor has the features for which it was compiled, and the files have the digests of the manifest. Any
other kernel is compiled, as without the folder.
"""

import hashlib
import json
import logging
import os
import pickle
import platform
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

from . import versions

log: logging.Logger = logging.getLogger(__name__)
MACHINE_CODE: Path = Path(__file__).parents[1] / "machine_code"
MANIFEST, INDEX, CODE = "manifest.json", ".index", ".code"
FEATURES: Mapping[str, tuple[str, ...]] = {
    "x86-64-v3": ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"),
    "generic": (),
}
"""The processors for which code is compiled, and the features, by LLVM's names, that they have beside the baseline."""
# Variables by which a user asks numba for other code than that of the wheel.
CHOICES = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NUMBA_OPT", "NUMBA_DEBUGINFO", "NUMBA_DISABLE_JIT")


def requirements() -> dict[str, str]:
    """Return what the code depends on: system, processor family, Python, and the versions of the compiler."""
    library_versions = versions.of_imported(("numba",))
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "python": str(sys.implementation.cache_tag),
        "numba": library_versions["numba"],
        "llvmlite": library_versions["llvmlite"],
        "numpy": ".".join(library_versions["numpy"].split(".")[:2]),
    }


def find(name: str, signature: Any, hashes: Any) -> bytes | None:
    """Return what numba pickled of the kernel of this name for a signature and its hashes; None if nothing fits."""
    files = _digests()
    if name + INDEX not in files:
        return None
    index = _read(name + INDEX)
    code = pickle.loads(index).get((signature, hashes)) if index else None
    return _read(code) if code else None


def _read(name: str) -> bytes | None:
    try:
        content = (MACHINE_CODE / name).read_bytes()
    except OSError:
        content = b""
    if hashlib.sha256(content).hexdigest() == _digests().get(name):
        return content
    log.warning("%s is damaged, so it is compiled here; install tangible-images again", MACHINE_CODE / name)
    return None


@cache
def _digests() -> Mapping[str, str]:
    """Return the SHA-256 of each file, by name; of none if there are none, or they do not fit this process."""
    try:
        manifest = json.loads((MACHINE_CODE / MANIFEST).read_bytes())
        wheel, lacking = manifest["requirements"], {*FEATURES[manifest["processor"]]} - _features()
        digests = dict[str, str](manifest["digests"])
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, KeyError, TypeError) as error:
        log.warning("%s cannot be read (%s); kernels are compiled here", MACHINE_CODE / MANIFEST, error)
        return {}
    differences = [
        f"{name} {here}, not {wheel.get(name)}" for name, here in requirements().items() if wheel.get(name) != here
    ]
    if differences or lacking or any(os.environ.get(name) for name in CHOICES):
        log.debug("machine code of the wheel is not used: %s", ", ".join([*differences, *sorted(lacking)]) or CHOICES)
        return {}
    return digests


def _features() -> set[str]:
    """Return the features of this processor, by LLVM's names."""
    from llvmlite import binding  # pyright: ignore[reportMissingTypeStubs]

    features: Mapping[str, bool] = cast(Any, binding).get_host_cpu_features()
    return {name for name, present in features.items() if present}
