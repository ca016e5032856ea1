"""A pipeline file for pictures that have none, and pictures in place of a file."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image

from command_line import tangible
from pictures import write_png
from tangible_core.errors import ConfigError
from tangible_core.files.writing import write_text
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.pipeline import load_pipeline
from tangible_core.pipeline.starter import are_pictures, scene_key, starter
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene_files import SceneFiles
from tangible_depth import Auto
from videos import greys, write_video


def waves(columns: int, rows: int, across: float) -> np.ndarray:
    """Make a grey picture of n waves from left to right."""
    wave = np.rint(127 + 120 * np.sin(np.linspace(0, 2 * np.pi * across, columns))).astype(np.uint8)
    return np.tile(wave, (rows, 1))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_png(tmp_path / "calm.png", waves(120, 160, 1))
    write_png(tmp_path / "my steep: one.png", waves(160, 120, 12))
    np.save(tmp_path / "map.npy", np.hypot(*np.indices((30, 60))))
    return tmp_path


def relief_mm(picture: str) -> float:
    config = parse_config(starter([Path(picture)], Path("p.yaml")).text, Path("p.yaml"), default_registry())
    return 1e3 * config.workspace.relief_m


def test_starter_values_suit_the_picture(folder: Path):
    made = starter([Path("calm.png")], folder / "p.yaml")
    config = parse_config(made.text, folder / "p.yaml", default_registry())
    assert isinstance(config.scene, SceneFiles) and config.scene.photo == folder / "calm.png"
    assert config.workspace.width_m == 0.06, "portrait: its longer side fits the device"
    assert made.scene.views is not None and made.scene.views.shape == (160, 120)
    assert (config.relief.by, config.relief_kind, config.size[1:3]) == ("edges", "edges", (0.002, 0.00025))
    assert all(line.count("#") for line in made.text.splitlines() if " mm " in line), "each length is explained"


def test_starter_of_a_video_is_as_high_as_its_edges_allow(folder: Path):
    """Edges would flicker; what is lighter is higher."""
    for name, most_mm in (("calm", 8.0), ("my steep: one", 3.9)):
        (folder / name).mkdir()
        picture = cv2.imread(f"{name}.png")
        write_video(folder / f"{name}.avi", [picture] * 2)
        text = starter([Path(f"{name}.avi")], Path("p.yaml")).text
        config = parse_config(text, Path("p.yaml"), default_registry())
        assert config.relief_kind == "photograph" and config.size.smooth_m == 0.0015
        assert 1e3 * config.size.relief_m <= most_mm
        assert (1e3 * config.size.relief_m == 8.0) == (name == "calm")


def test_starter_of_a_picture_whose_depth_a_network_finds(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Auto, "finds_depth", True)
    config = parse_config(starter([Path("calm.png")], Path("p.yaml")).text, Path("p.yaml"), default_registry())
    assert (config.relief_kind, config.relief.slope, config.size.relief_m) == ("depth", 1.1, 0.005)


def test_starter_of_heights_in_millimetres_keeps_their_size(folder: Path):
    tangible("export", "map.npy", "--to", "heights", "--out", ".", cwd=folder)
    for name in ("map-heights.json", "map-heights.tif", "map-heights.png"):
        assert are_pictures([Path(name)])
        config = parse_config(starter([Path(name)], Path("p.yaml")).text, Path("p.yaml"), default_registry())
        assert isinstance(config.scene, SceneFiles) and config.scene.height == folder / name
        assert config.size.width_m == pytest.approx(0.08)
        assert config.size.relief_m == pytest.approx(0.015)


def test_starter_of_a_map_on_the_ground_has_its_proportions(folder: Path):
    """60 x 30 cells of 5 x 20 m are 300 x 600 m: half as wide as long."""
    tags = [(33550, "d", 3, (5.0, 20.0, 0.0), True)]
    tifffile.imwrite("dem.tif", np.load("map.npy").astype(np.float32), extratags=tags)
    made = starter([Path("dem.tif")], folder / "p.yaml")
    assert parse_config(made.text, folder / "p.yaml", default_registry()).workspace.width_m == 0.04


@pytest.mark.parametrize("hole", [np.nan, np.inf, -np.inf])
def test_starter_of_a_map_with_nan_ignores_it_as_a_slope(folder: Path, hole: float):
    ramp = np.tile(np.linspace(0, 1, 60), (30, 1))
    np.save("ramp.npy", ramp)
    ramp[:, 0] = hole
    np.save("holed.npy", ramp)
    assert relief_mm("holed.npy") == pytest.approx(relief_mm("ramp.npy"), abs=0.5)
    np.save("unknown.npy", np.full((9, 9), hole))
    assert "scene: {height: unknown.npy}" in starter([Path("unknown.npy")], Path("p.yaml")).text


def test_starter_takes_a_map_a_pair_and_a_builtin_scene(folder: Path):
    assert "scene: {height: map.npy}" in starter([Path("map.npy")], Path("p.yaml")).text
    pair = starter([folder / "calm.png", folder / "calm.png"], folder / "sub" / "p.yaml").text
    assert f"left: {folder.as_posix()}/calm.png" in pair
    assert "scene: builtin/coins" in starter([Path("builtin/coins")], Path("p.yaml")).text
    with pytest.raises(ConfigError, match="did you mean 'builtin/coins'"):
        starter([Path("builtin/coin")], Path("p.yaml"))
    with pytest.raises(ConfigError, match="3 pictures: name one, or left and right"):
        starter([Path("calm.png")] * 3, Path("p.yaml"))
    assert are_pictures([Path("A.JPG")]) and not are_pictures([Path("a.yaml")])


def test_starter_of_a_video_reads_its_first_frame(folder: Path):
    greys(folder / "walk.avi", 3, shape=(120, 160))
    made = starter([Path("walk.avi")], folder / "p.yaml")
    config = parse_config(made.text, folder / "p.yaml", default_registry())
    assert isinstance(config.scene, SceneFiles) and config.scene.video == folder / "walk.avi"
    assert made.scene.frames is not None and are_pictures([Path("WALK.MP4")])
    assert (
        "walk.avi, its first frame: one picture, 160 x 120 pixels" in made.text and "layout: side-by-side" in made.text
    )
    with pytest.raises(ConfigError, match="left and right are two pictures"):
        starter([Path("walk.avi")] * 2, folder / "p.yaml")


def test_starter_of_a_stereo_jpeg_is_a_pair(folder: Path):
    Image.fromarray(np.zeros((20, 60), np.uint8)).save(folder / "both.JPS", format="JPEG")
    made = starter([folder / "both.JPS"], folder / "p.yaml")
    assert "\nscene: {stereo: both.JPS}\n" in made.text
    assert made.scene.views is not None and made.scene.views.right is not None
    assert made.scene.views.shape == (20, 30)


def test_new_writes_a_file_that_runs_and_never_overwrites(folder: Path):
    assert tangible("new", "my steep: one.png", "--out", "p.yaml", cwd=folder).returncode == 0
    text = (folder / "p.yaml").read_text()
    assert tangible("plan", "p.yaml", cwd=folder).returncode == 0
    again = tangible("new", "calm.png", "--out", "p.yaml", cwd=folder)
    assert (again.returncode, again.stderr) == (
        2, "p.yaml: is there already; --out FILE writes another one, --force writes over it\n"
    )  # fmt: skip
    assert (folder / "p.yaml").read_text() == text
    assert tangible("new", "calm.png", "--out", "p.yaml", "--force", cwd=folder).returncode == 0
    assert (folder / "p.yaml").read_text() != text
    assert "name a picture" in tangible("new", "p.yaml", cwd=folder).stderr


def test_picture_runs_without_a_file(folder: Path):
    done = tangible("run", "calm.png", "--set", "want=surface", "--set", "workspace.width_m=30 mm", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "`tangible new calm.png` writes them down" in done.stderr
    written = (folder / "out" / "calm" / "config.yaml").read_text()
    assert "width_m: 0.03" in written and f"{folder}/calm.png" in written
    assert tangible("plan", "out/calm/config.yaml", cwd=folder).returncode == 0
    assert not list(folder.glob("*.yaml")), "nothing is written beside the picture"
    other = tangible("plan", "calm.png", "--set", "scene=builtin/coins", cwd=folder)
    assert "builtin/coins" in other.stdout
    assert "name one pipeline file" in tangible("run", "a.yaml", "calm.png", cwd=folder).stderr
    assert "there is no such file (did you mean 'calm.png'?)" in tangible("run", "calmm.png", cwd=folder).stderr


NAMES = [
    "a\ntitle: X\nsafety: {max_force_n: 7}\n#.png",
    *(f"a{control}title: X.png" for control in "\r\t\x1b\x7f\x85\x9b\u2028\u2029\ufeff\uffff\udce9"),
    "$name {b: 'c\"} #d\\n.png",
]
"""Names that break a line, that a file of YAML or UTF-8 cannot hold as they are, or that look like YAML."""


class TestHostileNames:
    @pytest.mark.parametrize("name", NAMES, ids=ascii)
    def test_name_of_a_picture_is_read_back_and_adds_no_line(self, folder: Path, name: str):
        (folder / name).write_bytes((folder / "calm.png").read_bytes())
        text = starter([Path(name)], folder / "p.yaml").text
        assert text.count("\n") == starter([Path("calm.png")], folder / "p.yaml").text.count("\n")
        write_text(folder / "p.yaml", text)
        config = load_pipeline(folder / "p.yaml").config
        assert isinstance(config.scene, SceneFiles) and config.scene.photo == folder / name
        assert (config.title, config.safety.max_force_n) == ("", None)
        write_text(folder / "completed.yaml", config.as_yaml())
        assert load_pipeline(folder / "completed.yaml").config.scene == config.scene

    @pytest.mark.parametrize("name", [NAMES[0], "a\udce9.png"], ids=ascii)
    def test_picture_is_run_and_exported_under_a_plain_name(self, folder: Path, name: str):
        (folder / name).write_bytes((folder / "calm.png").read_bytes())
        done = tangible("run", name, "--set", "want=relief", "--out", "out", cwd=folder)
        assert done.returncode == 0, done.stderr
        outcomes = json.loads((folder / "out/outcomes.json").read_text("utf-8"))
        assert Path(outcomes["scene"]).name == name
        done = tangible("export", name, "--to", "swell,text", "--out", "out", cwd=folder)
        assert done.returncode == 0, done.stderr
        plain = re.sub("[\n\udce9]", " ", name.removesuffix(".png"))
        titles = [
            ElementTree.parse(drawing).getroot().findtext("{http://www.w3.org/2000/svg}title")
            for drawing in (folder / "out").glob("*.svg")
        ]
        assert titles and all(title is not None and title.startswith(plain) for title in titles)

    def test_file_that_is_written_has_a_plain_comment(self, folder: Path):
        text = starter([Path("calm.png")], folder / "a\nwant: relief\n.yaml").text
        assert "want: relief" not in text.splitlines()


@pytest.mark.parametrize("title", [r"a\nb", r"a\eb", r"a\x85b", r"a\Lb"])
def test_title_that_no_line_holds_is_refused(title: str):
    with pytest.raises(ConfigError, match=r"p.yaml:2:1: .*one line of text without control characters"):
        parse_config(f'scene: builtin/coins\ntitle: "{title}"\n', Path("p.yaml"), default_registry())
    kept = 'scene: builtin/coins\ntitle: "\\u00A0\U0001f642 z. B.\\n"\n'
    assert parse_config(kept, Path("p.yaml"), default_registry()).title.strip() == "🙂 z. B."


def test_picture_of_two_lenses_that_is_named_alone_is_a_pair(tmp_path: Path):
    one, other = (Image.new("RGB", (64, 48), colour) for colour in ("red", "blue"))
    one.save(tmp_path / "two.mpo", "MPO", save_all=True, append_images=[other])
    one.save(tmp_path / "one.mpo", "JPEG")
    assert scene_key(tmp_path / "two.mpo") == "stereo"
    assert scene_key(tmp_path / "one.mpo") == "photo"
