"""The documents say what the code says."""

import re
import tomllib
from pathlib import Path

import pytest

from tangible_core import load_method
from tangible_core.data import TICK_COLUMNS
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry
from tangible_core.plugins.touch import Filming

ROOT = Path(__file__).parents[1]
HOW_TO = ROOT / "docs/how-to"
PLUGIN_PAGE = HOW_TO / "write-a-plugin.md"


EXAMPLES = {
    "write-a-plugin.md": "third_party",
    "write-a-force-law.md": "force_law",
    "write-a-device.md": "device",
    "write-an-exporter.md": "exporter",
}
"""Pages, and the folders of the examples that they show."""
HOUSES = {path.name: path for path in [ROOT / "tangible_core", *sorted(ROOT.glob("plugins/*/tangible_*"))]}


@pytest.mark.whole
@pytest.mark.parametrize("house", HOUSES)
def test_architecture_page_names_every_room(house):
    page = ROOT.joinpath("docs/explanation/architecture.md").read_text(encoding="utf-8")
    [part] = re.findall(rf"^### {house}\n(.*?)(?=^##|\Z)", page, re.DOTALL | re.MULTILINE)
    rooms = {path.parent.relative_to(HOUSES[house]).as_posix() for path in HOUSES[house].rglob("*/__init__.py")}
    assert set(re.findall(r"^\| `(.+)/` \| \S", part, re.MULTILINE)) == rooms


@pytest.mark.whole
def test_architecture_page_draws_the_floors_as_they_are():
    page = ROOT.joinpath("docs/explanation/architecture.md").read_text(encoding="utf-8")
    contracts = tomllib.loads(ROOT.joinpath("pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    floors = [contract["layers"] for contract in contracts if contract["type"] == "layers"]
    assert len(floors) == 14
    assert not [layers for layers in floors if "```text\n" + "\n".join(layers) + "\n```" not in page]


def test_tasks_of_the_accessibility_page_have_the_tests_that_it_names():
    page = HOW_TO.joinpath("accessibility.md").read_text(encoding="utf-8")
    named = re.findall(r"^\| An? .* \| `(tests/\S+\.py)::(test_\w+)` \|$", page, re.MULTILINE)
    assert len(named) >= 10
    assert not [(file, name) for file, name in named if f"def {name}(" not in (ROOT / file).read_text("utf-8")]


@pytest.mark.parametrize(
    ("page", "path"),
    [
        (page, path)
        for page, folder in EXAMPLES.items()
        for path in sorted(ROOT.glob(f"examples/{folder}/**/*.*"))
        if path.suffix in (".py", ".yaml") and path.name not in ("__init__.py", "maker.py")
    ],
)
def test_page_shows_its_examples_as_they_are(page: str, path: Path):
    shown = HOW_TO.joinpath(page).read_text(encoding="utf-8")
    assert path.read_text(encoding="utf-8").strip() in shown


def test_readme_runs_its_first_lines_of_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    first, *_ = re.findall(r"```python\n(.*?)```", ROOT.joinpath("README.md").read_text("utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(first, names)
    assert len(names["recording"].time_s) == 1000
    assert next(tmp_path.glob("out/coins/*.stl")).stat().st_size > 10_000


@pytest.mark.parametrize("moment", sorted(name for name in vars(hooks.Specs) if name.startswith("tangible_")))
def test_plugin_page_names_every_hook(moment):
    assert f"`{moment}(" in PLUGIN_PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize(("page", "number"), [("materials", 6), ("export", 7), ("drawings", 2)])
def test_files_of_a_page_are_valid(tmp_path: Path, page: str, number: int):
    blocks = re.findall(r"```yaml\n(.*?)```", HOW_TO.joinpath(f"{page}.md").read_text("utf-8"), re.DOTALL)
    assert len(blocks) == number
    for text in sorted(blocks, key=lambda block: "my-materials.yaml\n" not in block):
        if "# my-materials.yaml\n" in text:
            tmp_path.joinpath("my-materials.yaml").write_text(text)
            continue
        scene = "" if re.search("^scene:", text, re.MULTILINE) else "scene: builtin/coins\n"
        parse_config(scene + text, tmp_path / "p.yaml", default_registry())


def test_recordings_page_reads_writes_and_names_every_column(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    page = HOW_TO.joinpath("recordings.md").read_text("utf-8")
    assert all(f"`{name}`" in page for name in TICK_COLUMNS)
    blocks = re.findall(r"```python\n(.*?)```", HOW_TO.joinpath("recordings.md").read_text("utf-8"), re.DOTALL)
    write, *read = sorted(blocks, key=lambda block: "Writer" not in block)
    monkeypatch.chdir(tmp_path)
    exec(write.replace("mine.nc", "hand.nc").replace("renderer", 'configuration="a: 1", renderer'), {})
    run = [block for block in read if "xarray" not in block]  # which is not installed with this package
    assert len(run) == 2
    for block in run:
        exec(block, {})


@pytest.mark.whole
def test_force_loop_page_runs_as_shown(capsys: pytest.CaptureFixture[str]):
    page = ROOT.joinpath("docs/explanation/servo.md").read_text("utf-8")
    pulled, shown, felt = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(pulled, {})
    assert capsys.readouterr().out == "BeaconState(part=1, why='')\n"
    exec(shown, {})
    films = issubclass(load_method("render", "proxy"), Filming)
    assert re.fullmatch(r"True 0 (0|1|None)\n" if films else "", capsys.readouterr().out)
    exec(felt, {})
    assert capsys.readouterr().out.startswith("200 ")


def test_devices_page_shows_valid_files():
    page = HOW_TO.joinpath("devices.md").read_text(encoding="utf-8")
    [text] = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    config = parse_config(text, Path("p.yaml"), default_registry())
    assert config.felt_device is not None and config.device is not None
    assert config.felt_device != config.device.method
    assert {listing.name for listing in default_registry().listings if listing.kind == "device"} <= set(
        re.findall(r"^\| `([a-z-]+)` \|", page, re.MULTILINE)
    )


def test_video_page_plays_its_examples(tmp_path: Path):
    import cv2
    import numpy as np

    from films import layered
    from tangible_core import Pipeline, Scene
    from tangible_depth import SemiGlobal
    from tangible_devices import Mock
    from tangible_render import Proxy

    blocks = re.findall(r"```python\n(.*?)```", HOW_TO.joinpath("video.md").read_text("utf-8"), re.DOTALL)
    here = (block.replace('"walk.mp4"', "walk, fps=20").replace("seconds=10", "seconds=0.5") for block in blocks[:3])
    feeling, frames, shown = here
    for number in range(4):
        views = layered(number, 1.0, np.random.default_rng(number))
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.hstack([views.left, views.right]))
    heights = np.full((4, 12, 16), 0.01, np.float32)
    names = {"walk": tmp_path, "height_m": heights[0], "waves": heights}
    exec(feeling, names)
    assert np.isfinite(names["recording"].frame).all() and names["recording"].frame.max() >= 4, "it repeats"
    once = Scene.video(tmp_path, layout="side-by-side", repeat=False)
    names["pipeline"] = Pipeline(once, depth=SemiGlobal(), render=Proxy())
    exec(frames, names)
    assert names["number"] == 3
    names["device"] = Mock(path="circle")
    exec(shown, names)
    assert names["number"] == 3
