from .checks import Check as Check
from .checks import CheckFailure as CheckFailure
from .kit import CheckResult as CheckResult
from .kit import checks as checks
from .kit import conforms as conforms
from .kit import run_checks as run_checks
