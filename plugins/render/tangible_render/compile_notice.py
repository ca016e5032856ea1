"""Says once a process that kernels are being compiled: it takes seconds, and happens once a machine.

Imports numba: the kernels import this module.
"""

import logging
from typing import Any

from numba.core import event

log = logging.getLogger(__name__)


class _CompileNotice(event.Listener):
    said = False

    def on_start(self, event: Any) -> None:
        module = event.data["dispatcher"].py_func.__module__
        if not self.said and module.startswith(__package__ or ""):
            self.said = True
            log.warning("compiling the force laws for this processor; the next process finds them on disk")

    def on_end(self, event: Any) -> None:
        pass


event.register("numba:compile", _CompileNotice())
