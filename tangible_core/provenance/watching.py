"""Waits for numba to be imported, and has its cache told what kernels depend on."""

import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

CACHING = "numba.core.caching"


def watch_numba() -> None:
    """See to it that numba's cache knows what kernels depend on: now, or as soon as numba is imported."""
    if CACHING in sys.modules:
        _tell(sys.modules[CACHING])
    elif not any(isinstance(each, _Watch) for each in sys.meta_path):
        sys.meta_path.insert(0, _Watch())


class _Watch:
    """A finder on `sys.meta_path`, so that `tangible --help` does not wait for numba."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """What the other finders say of numba's cache, which is told once it has run; of anything else nothing."""
        if fullname != CACHING:
            return None
        from importlib.util import find_spec

        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec and spec.loader:
            vars(spec.loader)["exec_module"] = _then_told(spec.loader.exec_module)
        return spec


def _then_told(run: Callable[[ModuleType], None]) -> Callable[[ModuleType], None]:
    def run_and_tell(module: ModuleType) -> None:
        run(module)
        _tell(module)

    return run_and_tell


def _tell(caching: ModuleType) -> None:
    from .numba_cache import tell

    tell(caching)
