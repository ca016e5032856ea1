"""The conformance kit: checks that every method must pass, run on yours.

    from tangible_core.testing import conforms
    test_mine = conforms("depth", "mine")

is a whole test module. `synthetic.scenes` has the analytic scenes of the checks, for your own tests.
"""

from .checks import Check as Check
from .checks import CheckFailure as CheckFailure
from .kit import CheckResult as CheckResult
from .kit import checks as checks
from .kit import conforms as conforms
from .kit import run_checks as run_checks
