"""The command line. Commands parse and print, and call functions that programs can call as well."""

from .app import main

__all__ = ["main"]
