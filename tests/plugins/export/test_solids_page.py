"""The examples of docs/export.md on solids; with TANGIBLE_DOCS_PICTURES=1 the picture of the page is written."""

import os
import re
from pathlib import Path

import numpy as np
from PIL import Image

from command_line import tangible
from drawn_parts import drawn
from pictures import write_png
from solids import FORMATS, is_closed, read, seen_from_above
from tangible_authoring.label_picture import label_picture

ROOT = Path(__file__).parents[3]
PAGES = {name: ROOT.joinpath("docs", f"{name}.md").read_text(encoding="utf-8") for name in ("parts", "export")}
SECTION = re.findall(r"^## Solids\n(.*?)^## ", PAGES["export"], re.DOTALL | re.MULTILINE)[0]
MOST_BYTES = 150_000


def test_page_example_portrait_becomes_a_plate(tmp_path: Path):
    parts, added = (re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)[0] for text in (PAGES["parts"], SECTION))
    astronaut = drawn("astronaut")
    write_png(tmp_path / "astronaut.png", astronaut.picture)
    (tmp_path / "parts.png").write_bytes(label_picture(astronaut.parts.labels))
    (tmp_path / "astronaut.yaml").write_text(f"{parts}\n{added}")
    words = re.findall(r"^\$ tangible (.*)$", SECTION, re.MULTILINE)[0].split()
    done = tangible(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    meshes = [read(path) for path in sorted(tmp_path.joinpath("print").glob("astronaut.[3s]*"))]
    assert len(meshes) == 2 and all(is_closed(mesh) for mesh in meshes)
    keep(seen_from_above(meshes[1]), tmp_path)


def test_page_lists_every_option_with_its_default():
    (table,) = re.findall(r"\| option \|.*?\n\n", SECTION, re.DOTALL)
    rows = dict(re.findall(r"^\| `(\w+)` \| (\S+(?: mm)?) \|", table, re.MULTILINE))
    for cls in FORMATS.values():
        fields = cls.model_fields.items()
        assert rows == {
            name: f"{1000 * field.default:g} mm"
            if name.endswith("_m")
            else str(field.default).lower().replace("none", "null")
            for name, field in fields
        }


def keep(picture: Image.Image, folder: Path) -> None:
    """Write it, small, where it is asked for; something is on it, and the page shows it."""
    assert "](export/solid.png)" in SECTION and np.asarray(picture).std() > 5
    path = (ROOT / "docs" if os.environ.get("TANGIBLE_DOCS_PICTURES") else folder) / "export" / "solid.png"
    path.parent.mkdir(exist_ok=True)
    picture.quantize(64, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(path, optimize=True)
    assert path.stat().st_size < MOST_BYTES
