"""Loading of compiled kernels without the parts of numba that are needed only to compile.

Before numba loads a function from its disk cache, it imports 72 modules of its own and SciPy's linear algebra, and
registers thousands of implementations: half a second, more than the import of numba. The function is machine code
by then, and needs none of that unless it uses numba's runtime: memory, strings, hashes. Our kernels do not
(`_nrt=False`), so that a process which compiles nothing saves this time. The first compilation does all of it by
itself.
"""

from typing import Any

from numba.core.caching import FunctionCache
from numba.core.dispatcher import Dispatcher

_dispatchers: Any = Dispatcher
_enable_caching = _dispatchers.enable_caching


class KernelCache(FunctionCache):
    """The disk cache of a kernel that does not use numba's runtime."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the compiled kernel for this signature; None if it is not on the disk."""
        cache: Any = self
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(sig, target_context)


def _enable_kernel_caching(dispatcher: Any) -> None:
    _enable_caching(dispatcher)
    if dispatcher.targetoptions.get("_nrt") is False and type(dispatcher._cache) is FunctionCache:
        dispatcher._cache.__class__ = KernelCache


def load_kernels_alone() -> None:
    """Give each kernel that is defined from now on with `_nrt=False` and `cache=True` this cache."""
    _dispatchers.enable_caching = _enable_kernel_caching
