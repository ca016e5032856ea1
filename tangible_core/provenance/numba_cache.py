"""numba's disk cache, told what a kernel depends on.

By itself it looks at the file that a kernel is in, and not at the modules which that file imports: yet their constants
and kernels are compiled in. Told, it names a file by the digest of the kernel's import closure too, so that a kernel is
found only where all of its sources are the same; whoever reads while another process writes finds nothing or the right
one. This holds for every kernel with `cache=True`, anyone's, that is defined after `tangible_core` was imported.
"""

import logging
from contextlib import suppress
from glob import escape
from pathlib import Path
from typing import Any

from .closure import closure_of_function

log = logging.getLogger(__name__)

KEPT = 4
"""Closures of a kernel whose compiled code stays: two branches or environments on one folder do not undo each other."""


def tell(caching: Any) -> None:
    """Let each cache of `numba.core.caching`, in whichever folder, look at closures.

    A kernel whose closure is not known, or changed since this process began, is compiled anew and not kept.
    """
    made, saved = caching.Cache.__init__, caching.Cache.save_overload

    def make(self: Any, py_func: Any) -> None:
        made(self, py_func)
        found = closure_of_function(py_func)
        if found is None or not found.settled:
            self.disable()
            return
        try:
            name = f"{self._impl.filename_base}-{found.digest}"
            self._cache_file = type(self._cache_file)(self.cache_path, name, self._impl.locator.get_source_stamp())
        except (AttributeError, TypeError) as error:
            self.disable()
            log.warning("this version of numba is unknown, so kernels are compiled in every process: %s", error)

    def save(self: Any, sig: Any, data: Any) -> None:
        saved(self, sig, data)
        _prune(Path(self.cache_path), self._impl.filename_base)

    caching.Cache.__init__, caching.Cache.save_overload = make, save


def _prune(folder: Path, kernel: str) -> None:
    with suppress(OSError):  # another process drops them at the same time
        indices = sorted(folder.glob(f"{escape(kernel)}-*.nbi"), key=lambda each: -each.stat().st_mtime_ns)
        for index in indices[KEPT:]:
            for each in folder.glob(f"{escape(index.stem)}.*"):
                each.unlink(missing_ok=True)
