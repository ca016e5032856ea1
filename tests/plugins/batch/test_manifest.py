"""The scenes of a batch and their cards: the picture before its product, lit from the upper left."""

from datetime import datetime
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import tifffile
from PIL import Image

from tangible_batch.job import CARD, write_card
from tangible_batch.manifest import find_rows, rows_from, setting_file
from tangible_core import Pipeline
from tangible_core.errors import BatchError
from tangible_core.files.yaml.source import parse_override
from videos import greys


def touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()


def scenes(over: Path | str) -> dict[str, tuple[str, ...]]:
    return {row.id: row.sets for row in find_rows(str(over))}


@pytest.mark.parametrize("ends", [("_left", "_right"), ("_l", "_r"), ("-left", "-right"), ("_L", "_R")])
def test_pair_has_its_left_view_on_the_left(tmp_path: Path, ends: tuple[str, str]):
    left, right = (f"vase{end}.png" for end in ends)
    touch(tmp_path, left, right)
    assert scenes(tmp_path) == {"vase": (f'scene.left="{tmp_path / left}"', f'scene.right="{tmp_path / right}"')}


def test_films_of_a_folder_without_pictures_are_scenes(tmp_path: Path):
    greys(tmp_path / "walk.avi", 2)
    assert scenes(tmp_path) == {"walk": (f'scene.video="{tmp_path / "walk.avi"}"',)}
    touch(tmp_path, "1.jpg", "1.png", "2.png", "a_left.png", "a_right.png", "a.jpg")
    found = scenes(tmp_path)
    assert list(found) == ["1.jpg", "1.png", "2", "a.jpg", "a.png"], "two of one name keep their suffixes"
    assert [len(sets) for sets in found.values()] == [1, 1, 1, 1, 2]


def test_folder_is_searched_to_its_depth_and_scenes_are_named_by_their_place(tmp_path: Path):
    touch(tmp_path, "a/one.png", "a/deep/one.JPG", "two.png", "notes.txt")
    assert list(scenes(tmp_path)) == ["a/deep/one", "a/one", "two"]


def test_rows_and_pictures_of_a_shell_are_named_in_order(tmp_path: Path):
    rows = [{"depth.smoothing_px": 0, "want": None}, {"id": "own", "want": ""}, {"want": "relief"}]
    assert [tuple(row) for row in rows_from(rows, tmp_path)] == [
        ("0", ("depth.smoothing_px=0",)),
        ("own", ()),
        ("2", ("want=relief",)),
    ]
    touch(tmp_path, "a/two.png", "a/one_left.png", "a/one_right.png", "b/c/film.png")
    given = [str(tmp_path / name) for name in ("b/c/film.png", "a/two.png", "a/one_right.png", "a/one_left.png")]
    assert [(row.id, len(row.sets)) for row in find_rows(given)] == [("a/one", 2), ("a/two", 1), ("b/c/film", 1)]
    assert [row.id for row in find_rows(given[1:])] == ["one", "two"]


@pytest.mark.parametrize("name", ["a\n\x1b\x7f\x85\u2028\uffff.png", "caf\udce9.png", "🙂 ä.png"], ids=ascii)
def test_picture_of_any_name_is_read_back_from_its_setting(tmp_path: Path, name: str):
    touch(tmp_path, name)
    ((setting,),) = scenes(tmp_path).values()
    assert parse_override(setting) == (("scene", "photo"), str(tmp_path / name))
    assert setting_file(setting) == tmp_path / name
    assert next(rows_from([{"scene.photo": name}], tmp_path)).sets == (setting,)


def test_files_left_out_of_a_folder_are_named(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    touch(tmp_path, "a.png", "._a.png", "film.mp4", "notes.txt")
    assert list(scenes(tmp_path)) == ["a"]
    assert f"{tmp_path}: left out: ._a.png, film.mp4, notes.txt" in caplog.text
    touch(tmp_path, *(f"{number}.txt" for number in range(9)))
    assert list(scenes(tmp_path)) == ["a"]
    assert "left out: ._a.png, 0.txt, 1.txt, 2.txt, 3.txt and 7 more" in caplog.text


def test_table_is_read_or_refused_with_its_name(tmp_path: Path):
    text = "id;scene.photo;workspace.width_m;title\r\nwide;a.png;0,1;Ein Krug, blau\r\n"
    (tmp_path / "rows.csv").write_text(text, encoding="utf-8-sig")
    photo = f'scene.photo="{tmp_path / "a.png"}"'
    assert scenes(tmp_path / "rows.csv") == {"wide": (photo, "workspace.width_m=0.1", "title=Ein Krug, blau")}
    (tmp_path / "rows.csv").write_text('id,title\na,"one\nb,two\n')
    with pytest.raises(BatchError, match=r"rows\.csv: line 3"):
        scenes(tmp_path / "rows.csv")
    path = tmp_path / "rows.parquet"
    pq.write_table(pa.table({"id": [f"scene {number}" for number in range(100)]}), path, compression="snappy")
    whole = path.read_bytes()
    for place in (0, 30, 80, -20, -2):
        data = bytearray(whole)
        data[place : place + 8 or None] = b"\xff" * 8
        path.write_bytes(data)
        with pytest.raises(BatchError, match=r"rows\.parquet: is not a Parquet file"):
            scenes(path)
    wide = [0.05 if number % 2 else None for number in range(5000)]
    pq.write_table(pa.table({"workspace.width_m": wide, "title": ["ä"] * 5000}), tmp_path / "rows.parquet")
    found = [tuple(row) for row in find_rows(str(tmp_path / "rows.parquet"))]
    given = (("workspace.width_m=0.05",) if number % 2 else () for number in range(5000))
    assert found == [(str(number), (*sets, "title=ä")) for number, sets in enumerate(given)]
    pq.write_table(pa.table({"want": [datetime(2026, 1, 1)]}), tmp_path / "rows.parquet")
    with pytest.raises(BatchError, match="'want'"):
        scenes(tmp_path / "rows.parquet")


@pytest.mark.parametrize(
    ("over", "names"),
    [
        ("*/x.png", ["[a]/x", "a/x"]), ("a/*.png", ["x", "y"]), ("a/x.png", ["x"]), ("b[1].png", ["b[1]"]),
        ("[a]/x.png", ["x"]), ("[a]/*.png", ["x"]), ("[a]", ["x"]), ("[ab]/*.png", ["a/x", "a/y"]),
    ],
)  # fmt: skip
def test_glob_names_scenes_from_the_folder_before_its_first_star(tmp_path: Path, over: str, names: list[str]):
    """Brackets of a folder that is there are no pattern."""
    touch(tmp_path, "[a]/x.png", "a/x.png", "a/y.png", "b[1].png", "b1.png")
    assert list(scenes(tmp_path / over)) == names


def test_files_are_felt_as_what_their_first_bytes_say(tmp_path: Path):
    np.save(tmp_path / "labels.npy", np.zeros((4, 5)))
    assert scenes(tmp_path) == {"labels": (f'scene.height="{tmp_path / "labels.npy"}"',)}, "maps alone are heights"
    tifffile.imwrite(tmp_path / "alps.tif", np.zeros((4, 5), np.float32))
    tifffile.imwrite(tmp_path / "cat.tif", np.zeros((4, 5), np.uint8))
    Image.new("L", (5, 4)).save(tmp_path / "dog", "PNG")
    Image.new("L", (5, 4)).save(tmp_path / "both.jps", "JPEG")
    keys = {name: sets[0].partition("=")[0] for name, sets in scenes(tmp_path).items()}
    assert keys == {"alps": "scene.height", "cat": "scene.photo", "dog": "scene.photo", "both": "scene.stereo"}


@pytest.mark.parametrize("want", ["parts", "relief"])
def test_card_shows_the_picture_and_then_the_parts_or_the_relief(tmp_path: Path, want: str):
    labels = np.repeat([[0, 1]], 40, 0).repeat(40, 1).astype(np.uint8)
    Image.fromarray(labels).save(tmp_path / "parts.png")
    Image.fromarray(np.full((40, 80, 3), (200, 30, 30), np.uint8)).save(tmp_path / "red.png")
    text = "scene: {photo: red.png, segments: parts.png}\nheights: {by: given}\n"
    (tmp_path / "mine.yaml").write_text(f"{text}want: {want}\n")
    write_card(Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path)
    with Image.open(tmp_path / CARD) as drawn:
        pixels = np.asarray(drawn).astype(int)
    assert np.ptp(pixels[40, 80]) > 100  # red: the picture
    left, right = pixels[40, 200], pixels[40, 280]
    assert np.ptp(left) < 10 and np.ptp(right) < 10
    assert (right[0] > 240 and left[0] < 15) == (want == "parts")


@pytest.mark.parametrize(("right", "down"), [(0.0, 0.0), (0.5, 0.0), (-0.3, 0.0), (0.0, 0.5), (0.2, -0.4)])
def test_slope_is_as_bright_as_its_angle_to_the_light(tmp_path: Path, right: float, down: float):
    """The relief is 0.04 m wide, of 160 cells or 640, and rises so much to the right and downwards."""
    normal, light = np.array([-right, -down, 1.0]), np.array([-1.0, -1.0, 1.2])
    expected = 255 * max(0.0, normal @ light / np.linalg.norm(normal) / np.linalg.norm(light))
    for cells in (160, 640):
        y, x = np.mgrid[:cells, :cells] * 0.04 / cells
        np.save(tmp_path / "slope.npy", (right * x + down * y).astype(np.float32))
        height_m = float(np.ptp(right * x + down * y)) or 0.01
        space = f"{{width_m: 0.04, relief_m: {height_m}, smooth_m: 0}}"
        (tmp_path / "mine.yaml").write_text(f"scene: {{height: slope.npy}}\nwant: relief\nworkspace: {space}\n")
        write_card(Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path)
        with Image.open(tmp_path / CARD) as drawn:
            assert int(np.asarray(drawn)[80, 80, 0]) == pytest.approx(expected, abs=3)
