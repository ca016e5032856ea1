"""Heights in millimetres: if a case fails, an exported relief comes back with another width or height, or damaged."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tangible_core import Pipeline, Relief, Scene, Workspace
from tangible_core.errors import ConfigError, PictureError
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins import Work
from tangible_core.plugins.registry import default_registry
from tangible_export import Heights

TENTH_UM = 1e-7
ENDINGS = ("json", "png", "tif")


def bumps(high_m: float = 0.01, low_m: float = 0.0012, shape: tuple[int, int] = (37, 53)) -> Relief:
    """Asymmetric, wider than long, and nowhere at the base."""
    rows, columns = np.indices(shape)
    values = np.sin(columns / 7) * np.cos(rows / 5) + columns / 40
    values = (values - values.min()) / (np.ptp(values) or 1)
    return Relief((low_m + (high_m - low_m) * values).astype(np.float32), (0.16, 0.16 * shape[0] / shape[1]))


def write(folder: Path, relief: Relief, title: str = "hills") -> dict[str, Path]:
    paths = Heights().write(Work(title, "de", {"relief": relief}), folder / "hills")
    return {path.suffix.removeprefix("."): path for path in paths}


def read(path: Path, **options: Any) -> Pipeline:
    return Pipeline(Scene.heights(path, **options), cached=False)


@pytest.mark.parametrize("ending", ENDINGS)
def test_heights_are_read_back_from_each_file(tmp_path: Path, ending: str):
    relief = bumps()
    read_back = read(write(tmp_path, relief)[ending]).relief
    assert read_back.extent_m == pytest.approx(relief.extent_m, abs=1e-12)
    assert np.abs(read_back.height_m.astype(float) - relief.height_m).max() <= TENTH_UM
    assert read_back.height_m.min() == pytest.approx(0.0012, abs=TENTH_UM)


def test_heights_size_in_the_pipeline_overrides_the_file(tmp_path: Path):
    path = write(tmp_path, bumps())["json"]
    half = Pipeline(Scene.heights(path), workspace=Workspace(width_m=0.08, relief_m=0.005), cached=False).relief
    assert half.extent_m[0] == 0.08
    assert (half.height_m.min(), half.height_m.max()) == pytest.approx((0.0006, 0.005), abs=TENTH_UM)


@pytest.mark.parametrize("high_m", [0.0, 0.3])
def test_heights_json_is_exact_for_any_height(tmp_path: Path, high_m: float):
    relief = bumps(high_m, low_m=0.0, shape=(37, 53) if high_m else (1, 1))
    files = write(tmp_path, relief)
    assert np.abs(read(files["json"]).relief.height_m - relief.height_m).max() <= TENTH_UM
    files["tif"].unlink()
    read_back = read(files["json"]).relief.height_m
    assert np.abs(read_back - relief.height_m).max() <= high_m / 65535 / 2 + 1e-8


def test_heights_files_are_read_by_pillow(tmp_path: Path):
    relief = bumps()
    files = write(tmp_path, relief, "Hügel «Süd»")
    head = json.loads(files["json"].read_text(encoding="utf-8"))
    assert (head["title"], head["language"]) == ("Hügel «Süd»", "de")
    with Image.open(files["png"]) as png, Image.open(files["tif"]) as tiff:
        from_png = np.asarray(png).astype(float) * head["step_mm"] + head["low_mm"]
        assert np.asarray(png).max() == 65535
        np.testing.assert_allclose(from_png, relief.height_m * 1000.0, atol=1e-4)
        np.testing.assert_allclose(np.asarray(tiff), relief.height_m * 1000.0, rtol=1e-6)


def test_heights_cropped_or_rotated_keep_their_scale_and_inverted_lose_it(tmp_path: Path):
    path = write(tmp_path, bumps())["json"]
    part = read(path, crop=[3, 4, 20, 10]).relief
    assert part.extent_m == pytest.approx((0.16 * 20 / 53, 0.16 * 10 / 53))
    np.testing.assert_allclose(part.height_m, bumps().height_m[4:14, 3:23], atol=TENTH_UM)
    turned = read(path, rotate=90).relief
    assert turned.extent_m == pytest.approx((0.16 * 37 / 53, 0.16))
    inverted = read(path, invert=True).relief
    assert (inverted.extent_m[0], inverted.height_m.min()) == (0.08, 0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width_mm": 0}, "width_mm"),
        ({"step_mm": -1}, "step_mm"),
        ({"format": "tangible heights 9"}, "format"),
        ({"rows": 5}, "is 53 x 37, but its metadata state 53 x 5"),
        ({"file": "../hills.png", "exact": ""}, "next to this one"),
        ({"file": "gone.png", "exact": ""}, "no such file"),
    ],
)
def test_heights_json_with_wrong_value_is_refused(tmp_path: Path, changes: dict[str, Any], message: str):
    files = write(tmp_path, bumps())
    plain = json.loads(files["json"].read_text())
    files["json"].write_text(json.dumps({**plain, "exact": "", **changes}))
    with pytest.raises(PictureError, match=message):
        read(files["json"])
    if "width_mm" in changes:
        with pytest.raises(ConfigError, match=r"p.yaml:1:9: .*hills-heights.json"):
            parse_config("scene: {height: hills-heights.json}", tmp_path / "p.yaml", default_registry())


@pytest.mark.parametrize("content", [b"{", b"[" * 10_000, b'"tangible heights 1"', b"{}", b"\xff"])
def test_heights_json_of_other_content_is_refused(tmp_path: Path, content: bytes):
    (tmp_path / "x.json").write_bytes(content)
    with pytest.raises(PictureError, match=r"x\.json"):
        read(tmp_path / "x.json")


def test_heights_saved_with_8_bits_keep_their_scale(tmp_path: Path):
    """A paint program saves colours of 8 bits."""
    relief, files = bumps(), write(tmp_path, bumps())
    eight = np.rint(np.asarray(Image.open(files["png"])).astype(np.uint16) / 257).astype(np.uint8)
    Image.fromarray(np.dstack([eight] * 3)).save(files["png"])
    found = read(files["png"])
    assert np.abs(found.relief.height_m - relief.height_m).max() < 0.0088 / 255 * 0.51
    assert any("its heights are in steps of 0.035 mm" in note for note in found.scene.notes)


def test_heights_that_were_painted_over_are_told(tmp_path: Path):
    files = write(tmp_path, bumps())
    numbers = np.asarray(Image.open(files["png"])).copy()
    numbers[numbers > 40_000] = 40_000
    Image.fromarray(numbers).save(files["png"])
    found = read(files["png"])
    expected_mm = 1.2 + 8.8 * 40_000 / 65_535
    assert found.relief.height_m.max() == pytest.approx(expected_mm / 1e3, abs=TENTH_UM)
    assert any(f"its highest place is {expected_mm:.4g} mm, and was 10 mm" in note for note in found.scene.notes)


@pytest.mark.parametrize("factor", [25.5, 0.1])
def test_exact_heights_with_other_numbers_are_refused(tmp_path: Path, factor: float):
    files = write(tmp_path, bumps())
    picture = Image.open(files["tif"])
    text = picture.tag_v2[270]
    Image.fromarray(np.asarray(picture) * np.float32(factor)).save(files["tif"], description=text)
    for ending in ("tif", "json"):
        with pytest.raises(PictureError, match="another program has changed its numbers"):
            assert read(files[ending]).relief


def test_heights_whose_text_went_by_mail_are_the_same(tmp_path: Path):
    files = write(tmp_path, bumps())
    files["json"].write_bytes(b"\xef\xbb\xbf" + files["json"].read_bytes().replace(b"\n", b"\r\n"))
    for ending in ("json", "png"):
        assert read(files[ending]).relief.extent_m == pytest.approx(bumps().extent_m)


def test_heights_under_another_name_are_told_to_lose_their_size(tmp_path: Path):
    files = write(tmp_path, bumps())
    for ending in ("png", "json"):
        files[ending].rename(tmp_path / f"copy.{ending}")
    assert any("copy.json describes hills-heights.png" in note for note in read(tmp_path / "copy.png").scene.notes)
