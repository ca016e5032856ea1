"""Do admesh and a slicer find nothing to repair in what an installed wheel exports? Run outside of the checkout.

Words: the program `tangible`, a pipeline file, a folder to write to, and what else `tangible export` is to be told.
"""

import subprocess
import sys
from pathlib import Path

REPAIRS = ("Degenerate", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards", "Normals f")


def told(*command: str) -> str:
    """Return what a program prints; it must succeed."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def repaired(stl: Path) -> int:
    """How much admesh repaired."""
    lines = [line for line in told("admesh", str(stl)).splitlines() if line.startswith(REPAIRS)]
    assert len(lines) == len(REPAIRS), "admesh says it in other words"
    return sum(int(line.split(":")[1].split()[0]) for line in lines)


def sliced(solid: Path) -> None:
    """Check that the slicer finds one closed part and slices it without a repair."""
    info = dict(line.split(" = ") for line in told("prusa-slicer", "--info", str(solid)).splitlines() if " = " in line)
    assert info["manifold"] == "yes" and int(info["number_of_parts"]) == 1, info
    gcode = solid.with_suffix(".gcode")
    said = told("prusa-slicer", "--export-gcode", "--layer-height", "0.2", "--output", str(gcode), str(solid))
    assert not any(word in said.lower() for word in ("repair", "open edge", "warning", "error")), said
    assert gcode.stat().st_size > 1_000_000


program, config, folder, *more = sys.argv[1:]
subprocess.run([program, "export", config, "--to", "stl,3mf", "--out", folder, *more], check=True)
[stl] = Path(folder).glob("*.stl")
assert repaired(stl) == 0
sliced(stl)
sliced(stl.with_suffix(".3mf"))
