"""The command line: a file a command. Commands parse and print; what they do, a program can call as well."""

from .app import main

__all__ = ["main"]
