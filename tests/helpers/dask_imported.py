"""Dask, imported: on older Pythons it brings a backport that finds what is installed in place of the standard library.

What that finds is of classes of its own, which checked calls of other tests in this process would complain of.
"""

import sys
from importlib.machinery import PathFinder

_found, _finders = PathFinder.find_distributions, list(sys.meta_path)

import distributed  # noqa: E402, F401

sys.meta_path[:] = [each for each in sys.meta_path if each in _finders or "metadata" not in type(each).__module__]
PathFinder.find_distributions = _found
