"""A hook that extends numba's cache as soon as numba is imported (see `numba_cache`)."""

import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

CACHING = "numba.core.caching"


def watch_numba() -> None:
    """Extend numba's cache by the dependencies of kernels, now or as soon as numba is imported."""
    if CACHING in sys.modules:
        _extend(sys.modules[CACHING])
    elif not any(isinstance(finder, _Watch) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Watch())


class _Watch:
    """A finder on `sys.meta_path`, so that `tangible --help` does not wait for numba."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find numba's cache by the other finders, to be extended after its import; None for any other module."""
        if fullname != CACHING:
            return None
        from importlib.util import find_spec

        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec and spec.loader:
            vars(spec.loader)["exec_module"] = _then_extend(spec.loader.exec_module)
        return spec


def _then_extend(run: Callable[[ModuleType], None]) -> Callable[[ModuleType], None]:
    def run_and_extend(module: ModuleType) -> None:
        run(module)
        _extend(module)

    return run_and_extend


def _extend(caching: ModuleType) -> None:
    from .numba_cache import extend

    extend(caching)
