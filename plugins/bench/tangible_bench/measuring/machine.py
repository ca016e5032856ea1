"""The machine on which measurements are made."""

import platform
import re
from functools import cache
from pathlib import Path


@cache
def machine() -> dict[str, str | int]:
    """Return the processor, the number of cores that this process may use, and the system."""
    from tangible_core.compiled.threads import thread_count

    return {"processor": _processor(), "cores": thread_count(), "system": f"{platform.system()} {platform.machine()}"}


def _processor() -> str:
    try:
        model = re.search(r"model name\s*: (.+)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    except OSError:
        model = None
    return model[1] if model else platform.processor() or platform.machine()
