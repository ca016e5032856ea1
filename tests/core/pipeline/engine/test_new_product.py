"""A new product is a row of the table and a stage: everything else follows from these two files."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[4]
TABLE = Path("tangible_core/data/products.py")
STAGE = Path("tangible_core/pipeline/engine/stages/flipped.py")
PROGRAM = """
import json, sys
import numpy as np
from tangible_core import Pipeline, Scene
from tangible_core.data.products import EXPORTABLE, IN_REPORT
from tangible_core.pipeline.config.schema import json_schema
from tangible_core.pipeline.output.run_folder import NAMES
from tangible_core.plugins.registry import default_registry

pipeline = Pipeline(Scene.heights(np.arange(12.0).reshape(3, 4)), cached=False)
plan = pipeline.plan("flipped")
flipped, relief = pipeline.make("flipped"), pipeline.make("relief")
print(json.dumps({
    "plan": [(each.product, each.outcome, each.why) for each in plan.steps],
    "right": bool((flipped.height_m == relief.height_m[:, ::-1]).all()),
    "outcomes": [each.product for each in pipeline.outcomes],
    "exportable": "flipped" in EXPORTABLE,
    "reported": "flipped" in IN_REPORT,
    "file": "flipped.npz" in NAMES,
    "schema": "flipped" in json_schema(default_registry(), None)["properties"]["want"]["enum"],
}))
"""


def test_product_of_the_contributing_page_is_known_everywhere_with_two_files(tmp_path: Path):
    shutil.copytree(ROOT / "tangible_core", tmp_path / "tangible_core", ignore=shutil.ignore_patterns("__pycache__"))
    name, row, stage = _example()
    table = (tmp_path / TABLE).read_text()
    table = table.replace('"surface", "touch"]', f'"surface", "{name}", "touch"]', 1)
    (tmp_path / TABLE).write_text(table.replace('    "touch": ProductRow', f'    {row}\n    "touch": ProductRow', 1))
    (tmp_path / STAGE).write_text(stage)
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    assert json.loads(ran.stdout) == {
        "plan": [
            ["relief", "given", "provided by the scene arrays"],
            ["flipped", "ran", "requested"],
        ],
        "right": True,
        "outcomes": ["relief", "flipped", "disparity", "segments", "materials", "surface", "touch"],
        "exportable": True,
        "reported": True,
        "file": True,
        "schema": True,
    }


def _example() -> tuple[str, str, str]:
    """Read the example of CONTRIBUTING.md: the product's name, its row, and the file of its stage."""
    section = (ROOT / "CONTRIBUTING.md").read_text().partition("## A new product")[2].partition("\n## ")[0]
    blocks = [block.partition("\n")[2] for block in section.split("```")[1::2]]
    row, stage = blocks
    return "flipped", row.strip(), stage
