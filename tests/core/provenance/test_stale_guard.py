"""The guard after an edit. Otherwise forces would be limited by an old layout of its settings."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import tangible_core

PUSHED_FOR_A_SECOND = """
import pytest

import tangible_core
from tangible_core.data import DeviceSpec
from tangible_core.servo import Safety
from tangible_core.servo.guard.guard import guard

settings, memory = Safety(ramp_s=0, passivity="off").arrays(DeviceSpec(8.0, 3000.0, 1.5, (0.1, 0.1, 0.1), 3e-5), 0.0)
left = [guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 300.0)[2] for _ in range(1000)]
print(tangible_core.__file__, max(left), len(guard.stats.cache_misses))
"""


def push(packages: Path) -> tuple[float, int]:
    """Return the greatest output force for 300 N on a device of 8 N, and the number of compilations of the guard."""
    environment = {**os.environ, "PYTHONPATH": str(packages), "NUMBA_CACHE_DIR": ""}
    done = subprocess.run(
        [sys.executable, "-P", "-c", PUSHED_FOR_A_SECOND], capture_output=True, text=True, check=True, env=environment
    )
    file, force_n, compiled = done.stdout.split()
    assert Path(file).is_relative_to(packages)
    return float(force_n), int(compiled)


@pytest.mark.whole
def test_guard_is_recompiled_after_an_edit_of_its_layout(tmp_path: Path):
    shutil.copytree(
        Path(tangible_core.__file__).parent, tmp_path / "tangible_core", ignore=shutil.ignore_patterns("__pycache__")
    )
    assert push(tmp_path) == (8.0, 1)
    layout = tmp_path / "tangible_core" / "servo" / "guard" / "layout.py"
    names = layout.read_text()
    exchanged = {"MAX_FORCE_N": "MAX_STIFFNESS", "MAX_STIFFNESS": "MAX_FORCE_N"}
    layout.write_text("".join(exchanged.get(word, word) for word in re.split(r"\b", names)))
    assert push(tmp_path) == (8.0, 1)
    (tmp_path / "tangible_core" / "pipeline" / "engine.py").write_text("")
    assert push(tmp_path) == (8.0, 0)
