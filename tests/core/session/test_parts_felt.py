"""The part under the tip, in reports and recordings: a wrong one misleads a person who does not see the picture."""

from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from loop_devices import Failing
from tangible_core.data import HapticSurface, Material, Relief, ServoReport
from tangible_core.errors import OutputError
from tangible_core.servo import Safety
from tangible_core.session import (
    About,
    Recording,
    Slot,
    material_under,
    materials_text,
    names_in,
    names_text,
    part_under,
    parts_felt,
    read_names,
    run_kiosk,
    run_simulated,
    with_parts,
)
from tangible_devices import Mock
from tangible_render import Penalty

LABELS = np.array([[0, 1], [2, 2]], np.int32)
NAMES = ("sky", "", "Gräser [hoch]")


def in_parts(labels: np.ndarray = LABELS, names: tuple[str, ...] | None = NAMES) -> HapticSurface:
    """Return a surface of 80 x 40 mm, 5 mm high, with parts upper left, upper right, and the lower half."""
    relief = Relief(np.full(labels.shape, 0.005, np.float32), (0.08, 0.04))
    return HapticSurface(relief, labels, None, names)


@pytest.mark.parametrize(
    ("x_mm", "y_mm", "called"),
    [
        (-20, 10, "sky"),
        (20, 10, "part 2"),
        (0, -10, "Gräser [hoch]"),
        (-40, 20, "sky"),
        (40, -20, "Gräser [hoch]"),
        (-41, 10, ""),
        (0, 20.5, ""),
        (np.nan, 0, ""),
    ],
)
def test_part_under_a_tip_is_named(x_mm: float, y_mm: float, called: str):
    assert part_under(in_parts(), (x_mm / 1000, y_mm / 1000, 0.1)) == called
    assert part_under(in_parts(names=None), (x_mm / 1000, y_mm / 1000, 0.1)) == "", "its labels are no parts"


def made_of(*materials: str, names: tuple[str, ...] | None = NAMES) -> HapticSurface:
    """Return the surface of `in_parts`, each part of a material."""
    found = tuple(Material(name, 500.0, 0.0, 0.0, 0.0) for name in materials)
    return replace(in_parts(names=names), materials=found)


@pytest.mark.parametrize("names", [NAMES, None], ids=["parts", "segments"])
def test_material_under_a_tip_is_named_for_parts_and_segments(names: tuple[str, ...] | None):
    surface = made_of("glass", "wood", "moss", names=names)
    places = [(-0.02, 0.01), (0.02, 0.01), (0.0, -0.01), (-0.041, 0.01), (np.nan, 0.0)]
    assert [material_under(surface, (x, y, 0.1)) for x, y in places] == ["glass", "wood", "moss", "", ""]
    assert material_under(in_parts(), (0.0, -0.01, 0.1)) == "", "it has parts and no materials"
    assert read_names(materials_text(surface)) == [{0: "glass", 1: "wood", 2: "moss"}]
    heard: list[ServoReport] = []
    run_simulated(Penalty().touch(surface), Mock(path="press"), 0.2, with_parts(surface, heard.append))
    assert {each.material for each in heard} == {"moss"}


def test_parts_felt_have_share_and_peak_force():
    places = [(-20, 10, 3.0)] * 5 + [(20, 10, 1.0)] * 3 + [(20, -10, 0.0)] * 9 + [(0, 30, 2.0), (-20, 10, 4.0)]
    position_m = np.array([(x / 1000, y / 1000, 0.0) for x, y, _ in places])
    force_n = np.array([(0.0, 0.0, force) for *_, force in places])
    time_s = np.arange(len(places)) / 1000
    felt = Recording.of(
        time_s=time_s, position_m=position_m, velocity_m_per_s=0 * position_m, force_n=force_n, buttons=0 * time_s
    )
    assert parts_felt(felt, in_parts()) == ((0, "sky", 0.6, 4.0, ""), (1, "", 0.3, 1.0, ""))
    assert [each.material for each in parts_felt(felt, made_of("a", "b", "c"))] == ["a", "b"]
    assert parts_felt(felt, in_parts(names=None)) == ()
    assert parts_felt(replace(felt, rows=felt.rows[:0]), in_parts()) == ()


@pytest.mark.usefixtures("loop_in_thread")
def test_reports_name_the_part_of_the_current_scene():
    said: list[str] = []
    both = Event()

    def hear(report: ServoReport) -> None:
        said.append(report.part)
        if {"door", "wall"} <= {*said}:
            both.set()

    scenes = [in_parts(0 * LABELS, ("door",)), in_parts(0 * LABELS, ("wall",))]
    turns = [Slot(Penalty().touch(surface), Safety(), surface) for surface in scenes]
    last = run_kiosk(turns, Failing(fault="none"), 60.0, 0.3, on_report=hear, stop=both)
    assert [*dict.fromkeys(filter(None, said))] == ["door", "wall"]
    assert last.part in ("door", "wall")


@pytest.mark.parametrize("suffix", [".nc", ".npz"])
def test_recording_has_the_names_of_parts(tmp_path: Path, suffix: str):
    said, of = names_text({6: "Gräser [hoch]", 0: 'a "wall"\n'}), names_text({6: "moss"})
    Recording(np.zeros((2, 17)), "", About("mock", parts=said, materials=of)).save(tmp_path / f"a{suffix}")
    about = Recording.load(tmp_path / f"a{suffix}").about
    assert read_names(about.parts) == [{0: 'a "wall"\n', 6: "Gräser [hoch]"}]
    assert (read_names(about.materials), about.device) == ([{6: "moss"}], "mock")


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("parts: {1: wall, '7': {name: helmet}, 3: {height_m: 1 mm}, 4: '', 5: null}", {0: "wall", 6: "helmet"}),
        ("scene: builtin/coins", None),
        ("parts: [wall]", None),
        ("parts: {wall: 0}", None),
        ("parts: {0: [", None),
        ("", None),
    ],
)
def test_names_are_read_from_the_text_of_a_pipeline_file(text: str, names: dict[int, str] | None):
    assert read_names(names_in(text)) == ([] if names is None else [names])


def test_names_of_kiosk_scenes_are_read_and_damaged_ones_refused():
    assert read_names('{"0": "door"}\n\n{"2": "wall"}') == [{0: "door"}, {}, {2: "wall"}]
    assert names_text({}) == ""
    for damaged in ("{", "[1]", '{"a": "b"}', "7"):
        with pytest.raises(OutputError, match="names of its parts are damaged"):
            read_names(damaged)
