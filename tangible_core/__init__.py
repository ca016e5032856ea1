"""Tangible Images: turn pictures into something one can feel.

The names below are for users of pipelines; `tangible_core.plugins` has those for authors of plugins. Each is imported
on first use, so that `tangible --help` does not wait for numpy.
"""

import lazy_loader  # pyright: ignore[reportMissingTypeStubs]

from .provenance.watching import watch_numba

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)  # pyright: ignore[reportUnknownVariableType]

watch_numba()
