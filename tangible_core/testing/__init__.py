"""The conformance kit: what every method keeps, run against yours.

    from tangible_core.testing import conforms
    test_mine = conforms("depth", "mine")

is a whole test module. `scenes` holds the analytic scenes the checks use, for tests of your own.
"""

from .checks import Check as Check
from .checks import CheckFailure as CheckFailure
from .kit import CheckResult as CheckResult
from .kit import checks as checks
from .kit import conforms as conforms
from .kit import run_checks as run_checks
