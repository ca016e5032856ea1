"""Custom files, matched by the stars of their patterns."""

from pathlib import Path

import pytest

from tangible_bench.datasets import match_files
from tangible_core.errors import ConfigError, PictureError

NEEDED = ("left", "right")


def touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()


@pytest.mark.parametrize(
    ("files", "patterns", "names"),
    [
        (["a_left.png", "a_right.png", "b_left.png", "b_right.png"], ("*_left.png", "*_right.png"), ["a", "b"]),
        (["l/1.png", "r/1.png", "l/x.txt"], ("l/*.png", "r/*.png"), ["1"]),
        (["a/1/L.png", "a/1/R.png", "a/2/L.png", "a/2/R.png"], ("a/*/L.png", "a/*/R.png"), ["1", "2"]),
        (["x/y/z/L1.png", "x/y/z/R1.png", "L2.png", "R2.png"], ("**/L*.png", "**/R*.png"), ["2", "x/y/z/1"]),
        (["s1/L01.png", "s1/R01.png", "s1/L011.png"], ("s?/L[0-9]1.png", "s?/R[0-9]1.png"), ["1/0"]),
        (["[x]/1.png", "[y]/1.png"], ("[[]x]/*.png", "[[]y]/*.png"), ["[/1"]),
        (["a+b/1.png", "a+c/1.png"], ("a+b/*.png", "a+c/*.png"), ["1"]),
    ],
)
def test_files_with_the_same_stars_are_matched(files, patterns, names, tmp_path: Path):
    touch(tmp_path, *files)
    found = match_files(tmp_path, dict(zip(NEEDED, patterns, strict=True)), NEEDED)
    assert list(found) == names
    for parts in found.values():
        assert parts["left"] != parts["right"] and all(path.is_file() for path in parts.values())


def test_optional_part_may_be_missing(tmp_path: Path):
    touch(tmp_path, "L1.png", "R1.png", "D1.pfm", "L2.png", "R2.png")
    found = match_files(tmp_path, {"left": "L*.png", "right": "R*.png", "truth": "D*.pfm"}, NEEDED)
    assert found["1"]["truth"] == tmp_path / "D1.pfm" and "truth" not in found["2"]


@pytest.mark.parametrize(
    ("patterns", "error", "why"),
    [
        ({"left": "L*.png", "right": "R.png"}, ConfigError, "right: 'R.png' has 0 stars and left: 'L*.png' has 1"),
        ({"left": "L1.png", "right": "R1.png"}, ConfigError, "each pattern needs as many, at least one"),
        (
            {"left": "Q*.png", "right": "R*.png"},
            PictureError,
            "no file in it matches left: 'Q*.png'; check the pattern",
        ),
        ({"left": "L*.png", "right": "R*.png"}, PictureError, "L2.png: no file matches right: 'R*.png' with the same"),
        ({"left": "no/L*.png", "right": "R*.png"}, PictureError, "no: there is no such folder for 'no/L*.png'"),
    ],
)
def test_wrong_patterns_are_refused_in_one_line(patterns, error, why, tmp_path: Path):
    touch(tmp_path, "L1.png", "R1.png", "L2.png")
    with pytest.raises(error) as said:
        match_files(tmp_path, patterns, NEEDED)
    assert why in str(said.value) and "\n" not in str(said.value)
