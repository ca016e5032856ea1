"""`tangible preflight --fix`: if a case fails, the file written is unsafe, or lacks what its owner wrote."""

import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import tangible
from tangible_core import load_pipeline
from tangible_core.preflight import Loop

STEEP = """\
# a photograph of mine
scene: {photo: mine.png}       # beside this file
want: touch
depth: luminance
texture: {use: gradient, segments: 3}
materials: {by: rules, default: brick, fit: never}
workspace:
  relief_m: 0.02   # as high as it goes
  smooth_m: 0
render: penalty-gradient
device: {use: mock}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "p.yaml").write_text(STEEP)
    noise = np.random.default_rng(0).normal(size=(60, 80)).cumsum(axis=0).cumsum(axis=1)
    cv2.imwrite(str(tmp_path / "mine.png"), cv2.normalize(noise, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8))
    return tmp_path


def test_unsafe_file_is_fixed_unless_there_is_no_cure(folder: Path):
    asked = "preflight", "p.yaml", "--seconds", 0.05
    assert tangible(*asked, cwd=folder).returncode == 1
    done = tangible(*asked, "--fix", "kept/fixed.yaml", "--set", "workspace.width_m=0.06", cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("Written: kept/fixed.yaml, in which the surface\n  ")
    first, *others = done.stdout.partition("\n\n")[0].splitlines()[1:]
    assert re.fullmatch(
        r"  (has materials that are felt more gently .*|is \d+ % as high \(`workspace.+`.*\))", first
    ), first
    assert others
    text = (folder / "kept/fixed.yaml").read_text()
    for kept in ("# a photograph of mine", "# beside this file", "# as high as it goes", "width_m: 60 mm"):
        assert kept in text
    fixed = load_pipeline(folder / "kept/fixed.yaml")
    assert fixed.scene.files.photo.resolve() == folder / "mine.png"
    assert fixed.preflight(loop=Loop(seconds=0.01)).safe
    assert (folder / "p.yaml").read_text() == STEEP
    (folder / "hard.yaml").write_text(
        "hard: {stiffness_n_per_m: 3000, damping_n_s_per_m: 0, static_friction: 0, dynamic_friction: 0, "
        "texture: smooth}\n"
    )
    text = (
        STEEP.replace("brick, fit: never", "hard, library: hard.yaml").replace("smooth_m: 0", "smooth_m: 0.002")
        + "safety: {coupling: {stiffness_n_per_m: 2900, damping_n_s_per_m: 0}}\n"
    )
    (folder / "p.yaml").write_text(text)
    done = tangible("preflight", "p.yaml", "--seconds", 0.05, "--rate", 100, "--fix", "fixed.yaml", cwd=folder)
    assert done.returncode == 1
    assert "on mock: Unsafe, because " in done.stdout
    assert done.stdout.startswith("Nothing was written: no cure is enough")
    assert not (folder / "fixed.yaml").exists()


def test_safe_file_is_written_unchanged(folder: Path):
    calm = (
        STEEP.replace(", fit: never", "")
        .replace("  smooth_m: 0\n", "")
        .replace("0.02 ", "0.004 ")
        .replace("penalty-gradient", "proxy")
    )
    (folder / "p.yaml").write_text(calm)
    done = tangible("preflight", "p.yaml", "--seconds", 0.05, "--fix", "fixed.yaml", cwd=folder)
    assert done.stdout.startswith("Written: fixed.yaml; nothing had to change\n\n")
    assert (folder / "fixed.yaml").read_text() == calm


def test_existing_file_is_overwritten_only_with_force(folder: Path):
    asked = "preflight", "p.yaml", "--seconds", 0.05, "--fix", "p.yaml"
    done = tangible(*asked, cwd=folder)
    assert (done.returncode, (folder / "p.yaml").read_text()) == (2, STEEP)
    assert "p.yaml: is there already; name another file, or --force writes over it" in done.stderr
    assert tangible(*asked, "--force", cwd=folder).returncode == 0
    assert (folder / "p.yaml").read_text() != STEEP
