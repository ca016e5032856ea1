"""Make `tour.ipynb` of `tour.py`: `python examples/notebook.py`. The script is the one to edit."""

import json
import re
from pathlib import Path

TOUR = Path(__file__).with_name("tour.py")


def cells(script: str) -> list[tuple[str, str]]:
    """Kind ("markdown" or "code") and text of each cell of a script whose cells begin with `# %%`."""
    _, *parts = re.split(r"^# %%", script, flags=re.MULTILINE)
    found: list[tuple[str, str]] = []
    for part in parts:
        head, _, text = part.partition("\n")
        if "[markdown]" in head:
            found.append(("markdown", re.sub(r"^# ?", "", text, flags=re.MULTILINE).strip()))
        else:
            found.append(("code", text.strip()))
    return found


def notebook(script: str) -> str:
    """Return the notebook's file, without results."""
    made = [
        {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": text.splitlines(keepends=True)}
        | ({"execution_count": None, "outputs": []} if kind == "code" else {})
        for number, (kind, text) in enumerate(cells(script))
    ]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {"cells": made, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    TOUR.with_suffix(".ipynb").write_text(notebook(TOUR.read_text(encoding="utf-8")), encoding="utf-8")
