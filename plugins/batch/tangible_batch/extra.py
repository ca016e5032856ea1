"""The optional extra `batch`: its import, or the words to install it."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from tangible_core.errors import BatchError


def need(name: str) -> ModuleType:
    """The module, such as `distributed`. Raises: BatchError saying how to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise _missing(name, error) from error


def need_all() -> None:
    """Before hours of work, look for what is needed at their end. Raises: BatchError saying how to install it."""
    for name in ("distributed", "pyarrow"):
        if find_spec(name) is None:
            raise _missing(name, "which is not there")


def _missing(name: str, why: object) -> BatchError:
    return BatchError(f"this needs {name} ({why}); pip install 'tangible-images[batch]'")
