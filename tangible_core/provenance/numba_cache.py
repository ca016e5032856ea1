"""numba's disk cache, extended by the dependencies of a kernel.

By itself, numba checks the file of a kernel and not the modules which that file imports, although their constants and
kernels are compiled in. Here the name of a cache file includes the digest of the kernel's import closure, so that a
kernel is loaded only if all of its sources are the same; a reader next to a writing process finds nothing or the right
kernel. This holds for every kernel with `cache=True`, of any package, that is defined after `tangible_core` is
imported.
"""

import logging
import pickle
from contextlib import suppress
from glob import escape
from pathlib import Path
from typing import Any

from . import machine_code
from .closure import SOURCE_DIGITS, closure_of_function

log: logging.Logger = logging.getLogger(__name__)

# The number of closures of a kernel whose code is kept, so that branches and environments can share a folder.
KEPT = 4


def extend(caching: Any) -> None:
    """Make each cache of `numba.core.caching`, in whichever folder, check closures."""
    numba_init, numba_load, numba_save = (
        getattr(caching.Cache, name) for name in ("__init__", "_load_overload", "save_overload")
    )

    def init(self: Any, py_func: Any) -> None:
        numba_init(self, py_func)
        closure = closure_of_function(py_func)
        if closure is None or not closure.settled:
            self.disable()
            return
        try:
            name = f"{self._impl.filename_base}-{closure.digest}"
            self._cache_file = type(self._cache_file)(self.cache_path, name, self._impl.locator.get_source_stamp())
            self.shipped_name = f"{self._impl.filename_base}-{closure.digest[:SOURCE_DIGITS]}"
        except (AttributeError, TypeError) as error:
            self.disable()
            log.warning("this version of numba is unknown, so kernels are compiled in every process: %s", error)

    def load(self: Any, sig: Any, target_context: Any) -> Any:
        compiled_here = numba_load(self, sig, target_context)
        if compiled_here is not None or not self._enabled:
            return compiled_here
        _, _, hashes = self._index_key(sig, target_context.codegen())
        code = machine_code.find(self.shipped_name, sig, hashes)
        return None if code is None else self._impl.rebuild(target_context, pickle.loads(code))

    def save(self: Any, sig: Any, data: Any) -> None:
        numba_save(self, sig, data)
        _prune(Path(self.cache_path), self._impl.filename_base)

    caching.Cache.__init__, caching.Cache._load_overload, caching.Cache.save_overload = init, load, save


def _prune(folder: Path, kernel: str) -> None:
    with suppress(OSError):  # another process may delete them at the same time
        indices = sorted(folder.glob(f"{escape(kernel)}-*.nbi"), key=lambda each: -each.stat().st_mtime_ns)
        for index in indices[KEPT:]:
            for each in folder.glob(f"{escape(index.stem)}.*"):
                each.unlink(missing_ok=True)
