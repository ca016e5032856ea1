"""What docs/parts.md tells is done here, as it stands there; with TANGIBLE_DOCS_PICTURES=1 its pictures are written."""

import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from command_line import tangible
from drawn_parts import drawn
from pictures import write_png
from tangible_authoring.label_picture import label_picture
from tangible_core import Pipeline, Scene, Workspace
from tangible_depth import Luminance

ROOT = Path(__file__).parents[1]
PAGE = ROOT.joinpath("docs", "parts.md").read_text(encoding="utf-8")
MOST_BYTES, SIDE_PX, COLOURS = 150_000, 560, 128
YAML = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture
def keep(tmp_path: Path) -> Callable[[str, Image.Image], None]:
    """Writes a picture, small, to where it is asked for; something is on it, and the page shows it."""

    def kept(name: str, picture: Image.Image) -> None:
        assert f"](parts/{name}.png)" in PAGE and np.asarray(picture).std() > 5
        folder = ROOT / "docs" / "parts" if os.environ.get("TANGIBLE_DOCS_PICTURES") else tmp_path / "pictures"
        folder.mkdir(exist_ok=True)
        picture.thumbnail((2 * SIDE_PX, SIDE_PX))
        small = picture.convert("RGB").quantize(COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        small.save(folder / f"{name}.png", optimize=True)
        assert (folder / f"{name}.png").stat().st_size < MOST_BYTES

    return kept


def test_photograph_becomes_a_relief_of_named_parts(
    tmp_path: Path, keep: Callable[[str, Image.Image], None], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("COLUMNS", "110")
    astronaut = drawn("astronaut")
    write_png(tmp_path / "astronaut.png", astronaut.picture)
    first = tangible("parts", "astronaut.png", cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    assert first.stdout.splitlines()[0] in PAGE
    keep("first", Image.open(tmp_path / "parts-numbered.png"))

    (tmp_path / "parts.png").write_bytes(label_picture(astronaut.parts.labels))
    with Image.open(tmp_path / "parts.png") as painted:
        keep("painted", painted.convert("RGB"))
    followed = tangible("parts", "astronaut.yaml", "--renumber", cwd=tmp_path)
    assert followed.returncode == 0, followed.stderr
    file, _ = YAML
    (tmp_path / "astronaut.yaml").write_text(file)
    listed = tangible("parts", "astronaut.yaml", cwd=tmp_path)
    assert listed.returncode == 0, listed.stderr
    assert lines(listed.stdout).strip() in PAGE
    keep("named", Image.open(tmp_path / "parts-numbered.png"))

    pipeline = Pipeline.from_yaml(tmp_path / "astronaut.yaml")
    assert pipeline.surface.names == tuple(pipeline.config.part_names.values())
    assert pipeline.surface.labels is not None and pipeline.surface.names[pipeline.surface.labels[440, 385]] == "helmet"
    bright = Pipeline(
        Scene.photo(astronaut.picture), depth=Luminance(), workspace=Workspace(width_m=0.08, relief_m=0.006)
    )
    keep("relief", beside(bright, pipeline))


def lines(text: str) -> str:
    """Without the spaces at the ends of lines."""
    return "\n".join(line.rstrip() for line in text.splitlines())


def beside(*pipelines: Pipeline) -> Image.Image:
    """Their reliefs, each as the sheet draws it."""
    from io import BytesIO

    from matplotlib import pyplot

    figure, every = pyplot.subplots(1, 2, figsize=(7.4, 3.9))
    for axes, pipeline, title in zip(every, pipelines, ("By brightness", "By parts"), strict=True):
        height_mm = 1000 * pipeline.relief.height_m
        down, right = np.gradient(height_mm, 80 / height_mm.shape[1])
        light = (right + down + 1.2) / np.sqrt(3.44 * (1 + right**2 + down**2))
        axes.imshow(light, cmap="gray", vmin=0, vmax=1)
        axes.set(title=title, xticks=[], yticks=[])
    figure.tight_layout()
    file = BytesIO()
    figure.savefig(file, dpi=110)
    pyplot.close(figure)
    return Image.open(file)
