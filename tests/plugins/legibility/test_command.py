"""`tangible legible`: if a case fails, what is judged is not what export draws, or a cure does not help."""

import json

import numpy as np
import pytest

from command_line import tangible
from pictures import write_png
from tangible_authoring.label_picture import label_picture


@pytest.fixture
def folder(tmp_path):
    """Write two halves, and a window of 4 mm in a picture of 60 mm."""
    labels = np.zeros((100, 150), np.int32)
    labels[:, 75:], labels[40:50, 30:40] = 1, 2
    (tmp_path / "parts.png").write_bytes(label_picture(labels))
    write_png(tmp_path / "photo.png", np.full((100, 150, 3), 128, np.uint8))
    scene = "scene: {photo: photo.png, segments: parts.png}\nworkspace: {width_m: 60 mm}\ndepth: luminance\n"
    drawn = "parts: {3: window}\nexport: [{use: swell, width_m: 60 mm}]\n"
    (tmp_path / "house.yaml").write_text(f"{scene}{drawn}simplify: {{gap_m: 0, part_m: 0}}\n")
    (tmp_path / "drawn.yaml").write_text(f"{scene}{drawn}")
    return tmp_path


def test_legible_small_part_prints_its_cure_and_exits_with_1(folder):
    found = tangible("legible", "house.yaml", "--for", "swell", cwd=folder)
    assert found.returncode == 1
    lines = found.stdout.splitlines()
    assert "60 mm wide, on swell paper: Illegible, because part 3 (window) is smaller than a" in lines[0]
    wrong = next(line for line in lines if line.startswith("illegible"))
    assert "part 3 (window), on the left, halfway down: 4 mm < 6.4 mm; tactilegraphics.org" in wrong
    assert (
        lines[lines.index(wrong) + 1]
        .split("cure: ")[1]
        .startswith("`simplify.part_m: 0.0064`, `export.swell.width_m: 0.0")
    )


def test_legible_judges_the_parts_that_export_draws_and_says_that_they_are_simplified(folder):
    """Judge a file without `simplify`: swell paper gets simplified parts all the same, a print does not."""
    found = tangible("legible", "drawn.yaml", "--for", "swell", cwd=folder)
    heading = found.stdout.splitlines()[0]
    assert heading.startswith("photo.png, its parts simplified, 60 mm wide, on swell paper: Legible"), heading
    assert "window" in found.stderr, "what is left out is said"
    exported = tangible("export", "drawn.yaml", "--json", cwd=folder)
    (drawn,) = json.loads(exported.stdout)["exports"]
    judged = json.loads(tangible("legible", "drawn.yaml", "--for", "swell", "--json", cwd=folder).stdout)
    assert judged["simplified"] is True
    assert judged["verdicts"] == drawn["legible"]["verdicts"]
    printed = tangible("legible", "drawn.yaml", "--for", "print", cwd=folder).stdout
    assert printed.startswith("photo.png, 160 mm wide, on a 3-D print: Illegible"), printed


def test_legible_is_judged_at_the_width_that_export_draws(folder):
    """As wide as the page allows, where the file gives no width for it; in print as its longer side says."""
    for medium, options, width_mm in (
        ("swell", "page=letter", 258),
        ("print", "longer_side_m=0.2", 200),
        ("force", "", 60),
    ):
        word = "swell" if medium == "swell" else "stl"
        words = ["--set", f"export=[{word}]", *(["--set", f"export.{word}.{options}"] if options else [])]
        found = json.loads(tangible("legible", "house.yaml", "--for", medium, "--json", *words, cwd=folder).stdout)
        assert found["width_m"] == pytest.approx(width_mm / 1000, abs=1e-3), medium


def test_legible_cure_of_a_width_is_an_option_of_the_exporter(folder):
    """The picture of 60 mm is to be 96 mm wide; what follows from the cure passes."""
    found = json.loads(tangible("legible", "house.yaml", "--for", "swell", "--json", cwd=folder).stdout)
    changes = [
        change for each in found["verdicts"] for change in each["changes"] if change["key"].startswith("export.")
    ]
    assert {each["key"] for each in changes} == {"export.swell.width_m"}
    words = ["--set", f"export.swell.width_m={changes[0]['value']}"]
    again = tangible("legible", "house.yaml", "--for", "swell", *words, cwd=folder)
    assert again.returncode == 0, again.stdout
