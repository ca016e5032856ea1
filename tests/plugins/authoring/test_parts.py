"""`tangible parts`: if a case fails, files do not run, or what a person wrote or painted of the parts is lost."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from command_line import Done, tangible
from full_disk import files_up_to
from pictures import write_png
from tangible_authoring.first_parts import first_parts
from tangible_authoring.renumbering import draw_numbers
from tangible_core.errors import OutputError
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.scene.formats.pictures import read_labels
from tangible_core.session import Recording, read_names

WALL, FLOOR, VASE = (90, 120, 200), (120, 80, 40), (200, 200, 60)
HERE = "parts.png", "parts-numbered.png", "still.yaml"


def still_life() -> np.ndarray:
    """120 x 160: a wall above a floor, a vase on the floor before the wall, and noise that no eye sees."""
    image = Image.new("RGB", (160, 120), WALL)
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, 80, 160, 120), FLOOR)
    draw.ellipse((60, 40, 100, 105), VASE)
    noise = np.random.default_rng(2).integers(-3, 4, (120, 160, 1))
    return np.clip(np.asarray(image) + noise, 0, 255).astype(np.uint8)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_png(tmp_path / "still.png", still_life())
    return tmp_path


def paint(labels: Path, box: tuple[int, int, int, int], colour: int) -> None:
    """Paint a box, as a paint program does that keeps the palette."""
    with Image.open(labels) as image:
        ImageDraw.Draw(image).rectangle(box, fill=colour)
        image.save(labels)


def well(done: Done) -> Done:
    assert done.returncode == 0, done.stderr
    return done


def test_picture_divided_into_parts_gives_files_that_run(folder: Path):
    done = well(tangible("parts", "still.png", cwd=folder))
    assert "still.png is divided into 3 parts" in done.stdout
    assert all(f"written: {name}" in done.stdout for name in HERE)
    assert sorted(path.name for path in folder.iterdir()) == sorted([*HERE, "still.png"])
    text = (folder / "still.yaml").read_text()
    assert "# part 2: in the middle, " in text and "# part 3: along the bottom, " in text
    assert "scene: {photo: still.png, segments: parts.png}" in text, "it can be moved with its pictures"
    assert "title: Still" in text
    labels = read_labels(folder / "parts.png")
    assert (labels[10, 80], labels[110, 10], labels[70, 80]) == (0, 2, 1), "wall, floor, vase: by their first pixels"
    made = Pipeline.from_yaml(folder / "still.yaml").surface
    assert made.labels is not None and made.names == ("", "", "")
    wall, vase, _ = (np.median(made.height_m[made.labels == part]) for part in range(3))
    assert wall < vase, "the vase stands before the wall"


def test_existing_file_and_picture_are_kept(folder: Path):
    well(tangible("parts", "still.png", cwd=folder))
    before = {name: (folder / name).read_bytes() for name in HERE}
    again = tangible("parts", "still.png", "--count", 2, cwd=folder)
    assert (again.returncode, again.stdout) == (2, "")
    assert again.stderr.startswith("parts.png: is there already")
    assert {name: (folder / name).read_bytes() for name in HERE} == before
    well(tangible("parts", "still.png", "--count", 2, "--force", "-q", cwd=folder))
    assert read_labels(folder / "parts.png").max() == 1
    (folder / "parts.png").rename(folder / "elsewhere.png")
    kept = tangible("parts", "still.png", cwd=folder)
    assert "parts-numbered.png: is there already" in kept.stderr and not (folder / "parts.png").exists()
    (folder / "still.png").rename(folder / "parts.png")
    before = (folder / "parts.png").read_bytes()
    done = tangible("parts", "parts.png", "--force", cwd=folder)
    assert (done.returncode, (folder / "parts.png").read_bytes()) == (2, before)
    assert "is the picture itself" in done.stderr


def test_pipeline_file_in_another_folder_finds_its_picture(folder: Path):
    done = well(tangible("parts", "still.png", "--out", "my parts/of it", "--json", cwd=folder))
    said = json.loads(done.stdout)
    assert [Path(each).name for each in said["files"]] == list(HERE) and said["title"] == "Still"
    assert [each["number"] for each in said["parts"]] == [0, 1, 2] and said["parts"][2]["place"] == "along the bottom"
    file = folder / "my parts" / "of it" / "still.yaml"
    assert "photo: ../../still.png" in file.read_text()
    well(tangible("plan", file, cwd=folder))
    assert not done.stderr and not (folder / "parts.png").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("nothing.png",), "nothing.png"),
        (("nothing.yaml",), "nothing.yaml"),
        (("map.npy",), "map of heights"),
        (("still.png", "--method", "gradent"), "gradent"),
        (("still.png", "--count", 0), "count"),
        (("still.png", "--smallest", "nan"), "smallest"),
        (("still.png", "--set", "render.use=proxy"), "render.use"),
        (("still.png", "small.png"), "size"),
        (("still.png", "still.png", "still.png"), "left and right"),
        (("bare.yaml",), "no parts"),
        (("bare.yaml", "bare.yaml"), "one pipeline file"),
    ],
)
def test_mistake_in_arguments_gives_one_line_with_the_cure(folder: Path, words: tuple[object, ...], said: str):
    np.save(folder / "map.npy", np.eye(9))
    write_png(folder / "small.png", still_life()[::2, ::2])
    (folder / "bare.yaml").write_text("scene: {photo: still.png}\nwant: segments\n")
    done = tangible("parts", *words, "--out", "new", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert said in done.stderr and not (folder / "new").exists()


def test_pair_has_heights_by_depth(folder: Path):
    wall = np.random.default_rng(5).integers(0, 255, (120, 170), dtype=np.uint8)
    left, right = wall[:, :160].copy(), wall[:, 4:164].copy()
    left[30:90, 60:110] = 255 - wall[30:90, 60:110] // 4
    right[30:90, 44:94] = 255 - wall[30:90, 60:110] // 4
    write_png(folder / "left.png", left)
    write_png(folder / "right.png", right)
    done = well(tangible("parts", "left.png", "right.png", "--method", "histogram", "--json", cwd=folder))
    parts = json.loads(done.stdout)["parts"]
    assert "disparity" in parts[0]["why"] and parts[0]["height_m"] == 0
    assert max(part["height_m"] for part in parts) == pytest.approx(0.0042)
    text = (folder / "left.yaml").read_text()
    assert "scene: {left: left.png, right: right.png, segments: parts.png}" in text and "depth: {use: " in text
    well(tangible("plan", "left.yaml", "--set", "heights.by=depth", cwd=folder))


def test_painted_parts_are_renumbered_on_request(folder: Path):
    """A person gives names, splits the wall, reads that numbers changed, lets the file follow, and goes on."""
    well(tangible("parts", "still.png", cwd=folder))
    file = folder / "still.yaml"
    named = file.read_text().replace('1: {name: ""', "1: {name: wall").replace('2: {name: ""', "2: {name: vase")
    file.write_text(named.replace('3: {name: ""', '3: {name: "floor [old]"'))
    shown = well(tangible("parts", "still.yaml", cwd=folder))
    assert "vase" in shown.stdout and "floor [old]" in shown.stdout and "written: parts-numbered.png" in shown.stdout
    drawn = (folder / "parts-numbered.png").read_bytes()

    paint(folder / "parts.png", (110, 0, 160, 40), 20)  # a window, whose first pixel comes before the vase's
    told = tangible("parts", "still.yaml", cwd=folder)
    assert told.returncode == 2 and "new" in told.stdout, told.stderr
    assert "2 (vase) is now 3, 3 (floor [old]) is now 4" in told.stderr
    assert (folder / "parts-numbered.png").read_bytes() == drawn, "what the numbers were is still known"

    well(tangible("parts", "still.yaml", "--renumber", cwd=folder))
    said = Pipeline.from_yaml(file)
    assert said.config.part_names == {0: "wall", 2: "vase", 3: "floor [old]"}
    heights = said.config.given_heights_m
    assert heights[1] == heights[0], "the window is as high as the wall that it was cut from"
    after = file.read_text()
    assert after.partition("parts:")[0] == named.partition("parts:")[0], "the rest stays, with its comments"
    assert "new, cut from what was part 1" in after
    assert said.surface.names == ("wall", "", "vase", "floor [old]")
    well(tangible("parts", "still.yaml", "--renumber", cwd=folder))
    assert file.read_text() == after, "once is enough"


def test_rule_by_an_old_number_is_refused(folder: Path):
    well(tangible("parts", "still.png", cwd=folder))
    file = folder / "still.yaml"
    rules = "materials: {rules: [{part: 2, material: glass}]}"
    file.write_text(file.read_text().replace("materials: {by: rules}", rules))
    paint(folder / "parts.png", (110, 0, 160, 40), 20)
    before = file.read_text()
    done = tangible("parts", "still.yaml", "--renumber", cwd=folder)
    assert done.returncode == 2 and "a rule of materials.rules is for part 2 by its number" in done.stderr
    assert file.read_text() == before


def test_parts_on_one_line_are_not_renumbered(folder: Path):
    well(tangible("parts", "still.png", cwd=folder))
    file = folder / "still.yaml"
    head, _, rest = file.read_text().partition("parts:\n")
    rest = "\n".join(line for line in rest.splitlines() if not line.startswith(("  1", "  2", "  3")))
    file.write_text(f"{head}parts: {{1: wall,\n2: vase,\n3: floor}}\n{rest}\n")
    paint(folder / "parts.png", (110, 0, 160, 40), 20)
    before, drawn = file.read_text(), (folder / "parts-numbered.png").read_bytes()
    done = tangible("parts", "still.yaml", "--renumber", cwd=folder)
    assert done.returncode == 2 and "`parts:` is not a block of lines" in done.stderr, done.stderr
    assert (file.read_text(), (folder / "parts-numbered.png").read_bytes()) == (before, drawn)


def test_full_disk_leaves_whole_files_or_none(folder: Path):
    found = first_parts([folder / "still.png"], folder / "still.yaml")
    sizes = [len(content) for content in found.contents.values()]
    assert [*found.contents] == [folder / name for name in HERE] and sizes[0] < sizes[1]
    with files_up_to(sizes[0] + 100), pytest.raises(OutputError, match=r"parts-numbered.png: cannot be written"):
        found.write()
    assert sorted(path.name for path in folder.iterdir()) == ["parts.png", "still.png"], "no file names a missing one"

    found.write(force=True)
    file = folder / "still.yaml"
    file.write_text(file.read_text().replace('2: {name: ""', "2: {name: vase"))
    paint(folder / "parts.png", (110, 0, 160, 40), 20)
    before = {name: (folder / name).read_bytes() for name in HERE}
    room = file.stat().st_size + 4096
    with files_up_to(room), pytest.raises(OutputError, match=r"parts-numbered.png: cannot be written"):
        draw_numbers(file, folder / "parts-numbered.png", renumber=True)
    assert {name: (folder / name).read_bytes() for name in HERE} == before, "numbers are not moved twice"


@pytest.mark.usefixtures("loop_in_thread")
def test_names_of_parts_reach_recording_and_replay(folder: Path):
    well(tangible("parts", "still.png", cwd=folder))
    file = folder / "still.yaml"
    file.write_text(
        file.read_text()
        .replace('1: {name: ""', "1: {material: glass, name: '[wall]'")
        .replace("path: raster", "path: press")
    )
    felt = well(tangible("feel", "still.yaml", "--seconds", 0.8, "--record", "hand.nc", "--json", cwd=folder))
    said = json.loads(felt.stdout)
    assert said["part"] in ("[wall]", "part 2", "part 3")
    assert sum(each["share"] for each in said["parts"]) == pytest.approx(1)
    about = Recording.load(folder / "hand.nc").about
    (materials,) = read_names(about.materials)
    assert read_names(about.parts) == [{0: "[wall]"}] and materials[0] == "glass"
    assert said["material"] in materials.values()
    assert [each["material"] for each in said["parts"]] == [materials[each["number"]] for each in said["parts"]]
    again = json.loads(well(tangible("replay", "hand.nc", "still.yaml", "--json", cwd=folder)).stdout)
    assert again["recorded"]["parts"] == [{"0": "[wall]"}] and again["recorded"]["materials"][0]["0"] == "glass"
    assert [each["number"] for each in again["parts"]] == [each["number"] for each in said["parts"]]
