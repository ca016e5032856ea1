"""The optional extra `batch`: imports of its packages, with an error that explains how to install it."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from tangible_core.errors import BatchError


def need(name: str) -> ModuleType:
    """Import a module, such as `distributed`. Raises: BatchError that explains how to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise _missing(name, error) from error


def need_all() -> None:
    """Check, before hours of work, that the packages needed at its end are installed. Raises: BatchError."""
    for name in ("distributed", "pyarrow"):
        if find_spec(name) is None:
            raise _missing(name, "which is not installed")


def _missing(name: str, why: object) -> BatchError:
    return BatchError(f"this needs {name} ({why}); pip install distributed pyarrow")
