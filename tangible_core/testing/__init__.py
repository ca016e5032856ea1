"""The conformance kit: checks that every method must pass, run on yours.

    from tangible_core.testing import conforms
    test_mine = conforms("depth", "mine")

is a whole test module. `synthetic.scenes` has the analytic scenes of the checks, for your own tests.
"""

import lazy_loader  # pyright: ignore[reportMissingTypeStubs]

# a file of this room has the same name: the last to be imported would win
from .kit import checks as checks

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)  # pyright: ignore[reportUnknownVariableType]
