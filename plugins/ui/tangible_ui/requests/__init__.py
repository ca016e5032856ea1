"""Requests that the server answers, one module per topic: every module in this folder is loaded, no list names them."""

from importlib import import_module
from pkgutil import iter_modules

from .table import REQUESTS, Request, find_request

__all__ = ["REQUESTS", "Request", "find_request"]

for _each in iter_modules(__path__):
    import_module(f"{__name__}.{_each.name}")
