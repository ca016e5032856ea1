"""The optional extra `batch`: its import, or the words to install it."""

from importlib import import_module
from types import ModuleType

from ..errors import BatchError


def need(name: str) -> ModuleType:
    """The module, such as `distributed`. Raises: BatchError saying how to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise BatchError(f"this needs {name} ({error}); pip install 'tangible-images[batch]'") from error
