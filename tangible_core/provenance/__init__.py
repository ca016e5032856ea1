"""The dependencies of a result or a compiled kernel: its code, and the versions of the libraries below it."""

import time

# The approximate start of this process: a file that changed later may not be the code that runs.
STARTED_NS = time.time_ns()
