"""Heights in millimetres, written and read back at their own width and height."""

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


@pytest.mark.parametrize("ending", ENDINGS)
def test_heights_are_read_by_a_pipeline_file(tmp_path: Path, ending: str):
    path = write(tmp_path, bumps())[ending]
    config = parse_config(f"scene: {{height: {path.name}}}", tmp_path / "p.yaml", default_registry())
    relief = Pipeline.from_config(config, default_registry(), None).relief
    assert relief.extent_m[0] == pytest.approx(0.16)
    assert (relief.height_m.min(), relief.height_m.max()) == pytest.approx((0.0012, 0.01), abs=TENTH_UM)
    assert config.as_data()["workspace"]["width_m"] == pytest.approx(0.16)


def test_heights_size_in_the_pipeline_overrides_the_file(tmp_path: Path):
    path = write(tmp_path, bumps())["json"]
    half = Pipeline(Scene.heights(path), workspace=Workspace(width_m=0.08, relief_m=0.005), cached=False).relief
    assert half.extent_m[0] == 0.08
    assert (half.height_m.min(), half.height_m.max()) == pytest.approx((0.0006, 0.005), abs=TENTH_UM)


@pytest.mark.parametrize("high_m", [0.0, 0.004, 0.02, 0.3])
def test_heights_json_is_exact_for_any_height(tmp_path: Path, high_m: float):
    relief = bumps(high_m, low_m=0.0)
    files = write(tmp_path, relief)
    assert np.abs(read(files["json"]).relief.height_m - relief.height_m).max() <= TENTH_UM
    files["tif"].unlink()
    read_back = read(files["json"]).relief.height_m
    assert np.abs(read_back - relief.height_m).max() <= high_m / 65535 / 2 + 1e-8


def test_heights_png_with_coarse_steps_is_noted(tmp_path: Path):
    def notes_of(high_m: float) -> list[str]:
        rows = np.linspace(0, high_m, 64, dtype=np.float32).reshape(8, 8)
        scene, workspace = Scene.heights(rows, relief_m=high_m or None), Workspace(relief_m=high_m)
        done = Pipeline(scene, workspace=workspace, cached=False).export(tmp_path / str(high_m), ["heights"])
        return [note.text for note in done.outcomes[0].notes]

    assert notes_of(0.01) == []
    (text,) = notes_of(0.02)
    assert "arrays-heights.png holds heights in steps of 0.31 um" in text
    assert "arrays-heights.tif holds them exactly" in text


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


def test_heights_cropped_or_rotated_keep_their_scale(tmp_path: Path):
    path = write(tmp_path, bumps())["json"]
    part = read(path, crop=[3, 4, 20, 10]).relief
    assert part.extent_m == pytest.approx((0.16 * 20 / 53, 0.16 * 10 / 53))
    np.testing.assert_allclose(part.height_m, bumps().height_m[4:14, 3:23], atol=TENTH_UM)
    turned = read(path, rotate=90).relief
    assert turned.extent_m == pytest.approx((0.16 * 37 / 53, 0.16))


def test_heights_inverted_lose_their_scale(tmp_path: Path):
    relief = read(write(tmp_path, bumps())["json"], invert=True).relief
    assert (relief.extent_m[0], relief.height_m.min()) == (0.08, 0)


def test_heights_json_of_another_picture_is_ignored(tmp_path: Path):
    path = write(tmp_path, bumps())["png"]
    other = path.rename(tmp_path / "other.png")
    (tmp_path / "other.json").write_text((tmp_path / "hills-heights.json").read_text())
    assert read(other).relief.extent_m[0] == 0.08


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width_mm": 0}, r"hills-heights.json: width_mm: Input should be greater than 0; export the heights again"),
        ({"step_mm": -1}, "step_mm"),
        ({"format": "tangible heights 9"}, "format"),
        ({"rows": 5}, "is 53 x 37, but its metadata state 53 x 5"),
        ({"file": "../hills.png", "exact": ""}, "it must be a file next to this one"),
        ({"file": "gone.png", "exact": ""}, "gone.png: there is no such file"),
    ],
)
def test_heights_json_with_wrong_value_is_refused(tmp_path: Path, changes: dict[str, Any], message: str):
    files = write(tmp_path, bumps())
    plain = json.loads(files["json"].read_text())
    files["json"].write_text(json.dumps({**plain, "exact": "", **changes}))
    with pytest.raises(PictureError, match=message):
        read(files["json"])
    if "rows" not in changes and "file" not in changes:
        with pytest.raises(ConfigError, match=r"p.yaml:1:9: .*hills-heights.json"):
            parse_config("scene: {height: hills-heights.json}", tmp_path / "p.yaml", default_registry())


@pytest.mark.parametrize("content", [b"", b"{", b"[" * 10_000, b'"tangible heights 1"', b"{}", b"\xff"])
def test_heights_json_of_other_content_is_refused(tmp_path: Path, content: bytes):
    (tmp_path / "x.json").write_bytes(content)
    with pytest.raises(PictureError, match=r"x\.json"):
        read(tmp_path / "x.json")


def test_heights_of_one_cell_or_flat_surface_are_read_back(tmp_path: Path):
    for number, relief in enumerate((bumps(shape=(1, 1)), Relief(np.full((3, 4), 0.002, np.float32), (0.08, 0.06)))):
        folder = tmp_path / str(number)
        folder.mkdir()
        for path in write(folder, relief).values():
            read_back = read(path).relief
            assert read_back.extent_m == pytest.approx(relief.extent_m)
            np.testing.assert_allclose(read_back.height_m, relief.height_m, atol=TENTH_UM)


def saved_again(path: Path, how: str) -> None:
    """Save a PNG of heights as a paint program does."""
    numbers = np.asarray(Image.open(path)).astype(np.uint16)
    eight = np.rint(numbers / 257).astype(np.uint8)
    if how == "8 bits":
        Image.fromarray(eight).save(path)
    elif how == "palette":
        Image.fromarray(eight).convert("P").save(path)
    elif how == "colours":
        Image.fromarray(np.dstack([eight] * 3)).save(path)
    else:
        Image.fromarray(np.dstack([eight, eight, eight, np.full_like(eight, 255)])).save(path)


@pytest.mark.parametrize("how", ["8 bits", "palette", "colours", "alpha"])
def test_heights_that_a_paint_program_saved_with_8_bits_keep_their_scale(tmp_path: Path, how: str):
    relief, files = bumps(), write(tmp_path, bumps())
    saved_again(files["png"], how)
    found = read(files["png"])
    assert np.abs(found.relief.height_m - relief.height_m).max() < 0.0088 / 255 * 0.51
    assert any("has 8 bits, and was exported with 16: its heights are in steps of 0.035 mm" in each
               for each in found.scene.notes)  # fmt: skip


def test_heights_that_were_painted_over_are_told(tmp_path: Path):
    files = write(tmp_path, bumps())
    numbers = np.asarray(Image.open(files["png"])).copy()
    numbers[numbers > 40_000] = 40_000
    Image.fromarray(numbers).save(files["png"])
    found = read(files["png"])
    expected_mm = 1.2 + 8.8 * 40_000 / 65_535
    assert found.relief.height_m.max() == pytest.approx(expected_mm / 1e3, abs=TENTH_UM)
    assert any(f"its highest place is {expected_mm:.4g} mm, and was 10 mm" in each for each in found.scene.notes)


@pytest.mark.parametrize("factor", [25.5, 0.1])
def test_exact_heights_with_other_numbers_are_refused(tmp_path: Path, factor: float):
    files = write(tmp_path, bumps())
    picture = Image.open(files["tif"])
    text = picture.tag_v2[270]
    Image.fromarray(np.asarray(picture) * np.float32(factor)).save(files["tif"], description=text)
    for ending in ("tif", "json"):
        with pytest.raises(PictureError, match=r"its metadata state 10 mm: another program has changed its numbers"):
            assert read(files[ending]).relief


def test_heights_that_were_resized_are_refused(tmp_path: Path):
    files = write(tmp_path, bumps())
    Image.open(files["png"]).resize((106, 74)).save(files["png"])
    with pytest.raises(PictureError, match="is 106 x 74, but its metadata state 53 x 37"):
        assert read(files["png"]).relief


@pytest.mark.parametrize("how", ["mark", "line ends"])
def test_heights_whose_text_went_by_mail_are_the_same(tmp_path: Path, how: str):
    files = write(tmp_path, bumps())
    data = files["json"].read_bytes()
    files["json"].write_bytes(b"\xef\xbb\xbf" + data if how == "mark" else data.replace(b"\n", b"\r\n"))
    for ending in ("json", "png"):
        assert read(files[ending]).relief.extent_m == pytest.approx(bumps().extent_m)


def test_heights_whose_text_has_decimal_commas_are_refused(tmp_path: Path):
    files = write(tmp_path, bumps())
    files["json"].write_text(files["json"].read_text().replace("160.0", "160,0"))
    for ending in ("json", "png"):
        with pytest.raises(PictureError, match=r"hills-heights.json: was changed and is not JSON any more: .* line"):
            assert read(files[ending]).relief


def test_heights_under_another_name_are_told_to_lose_their_size(tmp_path: Path):
    files = write(tmp_path, bumps())
    for ending in ("png", "json"):
        files[ending].rename(tmp_path / f"copy.{ending}")
    assert any("copy.json describes hills-heights.png" in each for each in read(tmp_path / "copy.png").scene.notes)
