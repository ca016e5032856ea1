"""Checks before a motor moves: of the surface, the force law, the device and this machine; a verdict a line."""

import lazy_loader  # pyright: ignore[reportMissingTypeStubs]

# a file of this room has the same name: the last to be imported would win
from .flight import survey as survey

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)  # pyright: ignore[reportUnknownVariableType]
