"""The machine that a measurement is of."""

import platform
import re
from functools import cache
from pathlib import Path


@cache
def machine() -> dict[str, str | int]:
    """Processor, how many of its cores this process may use, and system."""
    from tangible_core.compiled.threads import thread_count

    return {"processor": _processor(), "cores": thread_count(), "system": f"{platform.system()} {platform.machine()}"}


def _processor() -> str:
    try:
        found = re.search(r"model name\s*: (.+)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    except OSError:
        found = None
    return found[1] if found else platform.processor() or platform.machine()
