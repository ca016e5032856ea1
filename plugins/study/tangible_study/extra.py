"""The optional extra `study`: imports of its packages, with an error that explains how to install it."""

from importlib import import_module
from types import ModuleType

from tangible_core.errors import ConfigError


def need(name: str) -> ModuleType:
    """Import a module, such as `questplus`. Raises: ConfigError that explains how to install it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ConfigError(f"this needs {name} ({error}); pip install questplus psignifit") from error
