"""Write the table of docs/reference/platforms.md from the results of `tried.py`: `python platforms.py RESULTS PAGE`."""

import json
import sys
from pathlib import Path
from typing import Any

STEPS = ("demo", "run", "feel", "export", "ui", "compare", "batch", "video", "interrupted", "held", "console", "rooms")
HOW = {
    "linux": "this machine, the pinned versions",
    "windows": "Windows Python under wine",
    "arm64": "arm64 Python under qemu",
    "python3.13": "Debian trixie's Python, newest versions",
    "lowest": "this machine, the lowest versions that are allowed",
    "newest": "this machine, the newest versions",
}
"""The name of a result -> how it was tried."""
BEGIN, END = "<!-- table -->", "<!-- end of the table -->"


def row(name: str, result: dict[str, Any], reference: dict[str, str]) -> str:
    """Return the row of a result; reference: the digests of the products here."""
    if not result.get("steps"):
        return f"| {HOW[name]} | | | not run | | |"
    steps = result["steps"]
    ran = [each for each in STEPS if each in steps and not steps[each].startswith("FAILED")]
    failed = [f"{each}: {steps[each].removeprefix('FAILED: ')}" for each in STEPS if each in steps and each not in ran]
    if left_out := [each for each in STEPS if each not in steps and each != "rooms"]:
        failed.append(f"not tried: {', '.join(left_out)}")
    digests = result.get("digests", {})
    other = sorted(each for each, digest in digests.items() if each in reference and reference[each] != digest)
    same = f"other bits in {', '.join(other)}" if other else "to the bit" if digests and reference else "not compared"
    notes = [f"{each}: {steps[each]}" for each in ("feel", "interrupted", "rooms") if each in ran]
    notes += [f"left in the temporary folder: {', '.join(result['left'])}"] if result.get("left") else []
    cells = HOW[name], result["system"], f"{result['python']}, {result['date']}", ", ".join(ran) or "nothing"
    return "| " + " | ".join([*cells, "; ".join([*failed, *notes]).replace("|", "/") or "nothing", same]) + " |"


def main() -> None:
    """Write the table."""
    folder, page = map(Path, sys.argv[1:])
    found = {path.stem: json.loads(path.read_text("utf-8")) for path in folder.glob("*.json")}
    results = {name: found.get(name, {}) for name in HOW}
    reference = results["linux"].get("digests", {})
    titles = "how", "system", "Python, day", "ran", "failed, and why", "depth, parts, surface, forces"
    head = f"| {' | '.join(titles)} |\n{'|---' * len(titles)}|"
    table = "\n".join([head, *(row(name, result, reference) for name, result in results.items())])
    before, _, rest = page.read_text("utf-8").partition(BEGIN)
    page.write_text(f"{before}{BEGIN}\n\n{table}\n\n{END}{rest.partition(END)[2]}", "utf-8")


if __name__ == "__main__":
    main()
