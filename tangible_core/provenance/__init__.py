"""The dependencies of a result or a compiled kernel: its code, and the versions of the libraries below it.

One digest, of a `closure.Closure`, decides whether a cached result, a measured row and a compiled kernel still fit the
code. The code is read and not imported, and `tangible_core` imports only `watching` of this room.
"""

import time

STARTED_NS = time.time_ns()
"""The approximate start of this process: a file that changed later may not be the code that runs."""
