"""Pictures in place of a pipeline file. Otherwise somebody could not begin, or a name of a file would act as a key."""

import json
from pathlib import Path

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
from videos import write_video


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


def test_starter_of_pictures_videos_and_maps_suits_them(folder: Path, monkeypatch: pytest.MonkeyPatch):
    for name, most_mm in (("calm", 8.0), ("my steep: one", 3.9)):
        (folder / name).mkdir()
        picture = cv2.imread(f"{name}.png")
        write_video(folder / f"{name}.avi", [picture] * 2)
        text = starter([Path(f"{name}.avi")], Path("p.yaml")).text
        config = parse_config(text, Path("p.yaml"), default_registry())
        assert config.relief_kind == "photograph" and config.size.smooth_m == 0.0015
        assert 1e3 * config.size.relief_m <= most_mm
        assert (1e3 * config.size.relief_m == 8.0) == (name == "calm")
    tangible("export", "map.npy", "--to", "heights", "--out", ".", cwd=folder)
    for name in ("map-heights.json", "map-heights.tif", "map-heights.png"):
        assert are_pictures([Path(name)])
        config = parse_config(starter([Path(name)], Path("p.yaml")).text, Path("p.yaml"), default_registry())
        assert isinstance(config.scene, SceneFiles) and config.scene.height == folder / name
        assert config.size.width_m == pytest.approx(0.08)
        assert config.size.relief_m == pytest.approx(0.015)
    tags = [(33550, "d", 3, (5.0, 20.0, 0.0), True)]
    tifffile.imwrite("dem.tif", np.load("map.npy").astype(np.float32), extratags=tags)
    made = starter([Path("dem.tif")], folder / "p.yaml")
    assert parse_config(made.text, folder / "p.yaml", default_registry()).workspace.width_m == 0.04
    made = starter([Path("calm.png")], folder / "p.yaml")
    config = parse_config(made.text, folder / "p.yaml", default_registry())
    assert isinstance(config.scene, SceneFiles) and config.scene.photo == folder / "calm.png"
    assert config.workspace.width_m == 0.06, "portrait: its longer side fits the device"
    assert made.scene.views is not None and made.scene.views.shape == (160, 120)
    assert (config.relief.by, config.relief_kind, config.size[1:3]) == ("edges", "edges", (0.002, 0.00025))
    monkeypatch.setattr(Auto, "finds_depth", True)
    config = parse_config(starter([Path("calm.png")], Path("p.yaml")).text, Path("p.yaml"), default_registry())
    assert (config.relief_kind, config.relief.slope, config.size.relief_m) == ("depth", 1.1, 0.005)


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
    for pictures in ([Path("builtin/coin")], [Path("calm.png")] * 3, [Path("walk.avi")] * 2):
        with pytest.raises(ConfigError):
            starter(pictures, Path("p.yaml"))
    assert are_pictures([Path("A.JPG")]) and are_pictures([Path("WALK.MP4")]) and not are_pictures([Path("a.yaml")])
    one, other = (Image.new("RGB", (64, 48), colour) for colour in ("red", "blue"))
    one.save("two.mpo", "MPO", save_all=True, append_images=[other])
    one.save("one.mpo", "JPEG")
    assert (scene_key(Path("two.mpo")), scene_key(Path("one.mpo"))) == ("stereo", "photo")


def test_new_writes_a_file_that_runs_and_never_overwrites(folder: Path):
    assert tangible("new", "my steep: one.png", "--out", "p.yaml", cwd=folder).returncode == 0
    text = (folder / "p.yaml").read_text()
    assert tangible("plan", "p.yaml", cwd=folder).returncode == 0
    assert tangible("new", "calm.png", "--out", "p.yaml", cwd=folder).returncode == 2
    assert (folder / "p.yaml").read_text() == text
    assert tangible("new", "calm.png", "--out", "p.yaml", "--force", cwd=folder).returncode == 0
    assert (folder / "p.yaml").read_text() != text
    assert "name a picture" in tangible("new", "p.yaml", cwd=folder).stderr


def test_picture_runs_without_a_file(folder: Path):
    done = tangible("run", "calm.png", "--set", "want=surface", "--set", "workspace.width_m=30 mm", cwd=folder)
    assert done.returncode == 0, done.stderr
    written = (folder / "out" / "calm" / "config.yaml").read_text()
    assert "width_m: 0.03" in written and f"{folder}/calm.png" in written
    assert tangible("plan", "out/calm/config.yaml", cwd=folder).returncode == 0
    assert not list(folder.glob("*.yaml")), "nothing is written beside the picture"
    assert "builtin/coins" in tangible("plan", "calm.png", "--set", "scene=builtin/coins", cwd=folder).stdout
    assert "name one pipeline file" in tangible("run", "a.yaml", "calm.png", cwd=folder).stderr
    assert tangible("plan", "calm.png", "--set", "workspace.scale=1:2", cwd=folder).stderr.startswith("calm.png: w")
    assert "did you mean 'calm.png'" in tangible("run", "calmm.png", cwd=folder).stderr
    name = "a\udce9.png"
    (folder / "calm.png").rename(folder / name)
    assert tangible("export", name, "--to", "text", "--out", "out", cwd=folder).returncode == 0
    done = tangible("run", name, "--set", "want=relief", "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert Path(json.loads((folder / "out/outcomes.json").read_text("utf-8"))["scene"]).name == name


NAMES = [
    "a\ntitle: X\nsafety: {max_force_n: 7}\n#.png",
    *(f"a{control}title: X.png" for control in "\r\x1b\x85\u2028\ufeff\uffff\udce9"),
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
