"""What a result or a compiled kernel depends on: its code, and the versions of the libraries below.

One digest, that of a `closure.Closure`, decides whether a cached result, a measured row and a compiled kernel are still
what the code says. Nothing that is looked at is imported, and `tangible_core` imports no more of this room than
`watching`.
"""

import time

BEGUN_NS = time.time_ns()
"""When this process began, near enough: a file that was changed later may not be what runs."""
