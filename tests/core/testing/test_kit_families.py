"""Every check of the kit. Otherwise a method with the fault that a check is there for would pass."""

from collections.abc import Callable
from datetime import datetime
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from tangible_core import DisparityMap, Force, HapticState, HapticSurface, SegmentMap, Views
from tangible_core.data import NO_FORCE
from tangible_core.data.pictures import to_grey
from tangible_core.errors import BrokenMethod, DeviceAbsent, DeviceError, PictureError
from tangible_core.plugins import (
    DepthEstimator,
    DeviceSpec,
    Exporter,
    ForceRenderer,
    HapticDevice,
    Link,
    Segmenter,
    Touch,
    Work,
)
from tangible_core.testing import CheckFailure, kinds
from tangible_core.testing.kinds.export import demand_whole

ticket = count()
"""A counter that gives methods a forbidden memory."""


def right_depth(views: Views) -> DisparityMap:
    """Return six pixels wherever there is texture: the disparity of the kit's wall."""
    if views.right is None:
        raise PictureError("a pair is needed")
    known = np.ptp(to_grey(views.left)) > 0 or views.shape == (1, 1)
    return DisparityMap(np.full(views.shape, 6.0 if known else np.nan, np.float32))


class Depth(DepthEstimator):
    needs_pair: ClassVar[bool] = True
    twist: Callable[[Views], DisparityMap] = right_depth

    def estimate(self, views: Views) -> DisparityMap:
        return self.twist(views)


def scribble(picture: np.ndarray) -> None:
    picture.base[0, 0] = 0


DEPTH: dict[str, Callable[[Views], Any]] = {
    "map_is_well_formed": lambda views: DisparityMap(right_depth(views).disparity_px, np.full(views.shape, 1.5, "f4")),
    "wall_is_found": lambda views: DisparityMap(right_depth(views).disparity_px + np.float32(0.6)),
    "same_views_same_map": lambda views: DisparityMap(np.full(views.shape, next(ticket), np.float32)),
    "views_are_not_written_to": lambda views: scribble(views.left) or right_depth(views),
    "every_picture_type_is_taken": lambda views: DisparityMap(np.full(views.shape, views.left.max(), np.float32)),
    "any_size_is_taken": lambda views: DisparityMap(right_depth(views).disparity_px[:8]),
    "flat_pair_claims_nothing": lambda views: DisparityMap(np.zeros(views.shape, np.float32)),
    "one_view_is_answered": lambda views: DisparityMap(np.zeros(views.shape, np.float32)),
}


def right_segments(picture: np.ndarray) -> SegmentMap:
    grey = to_grey(picture)
    if np.ptp(grey) < 0.2:
        return SegmentMap(np.zeros(grey.shape, np.int32))
    return SegmentMap((grey > (grey.min() + grey.max()) / 2).astype(np.int32))


class Texture(Segmenter):
    twist: Callable[[np.ndarray], SegmentMap] = right_segments

    def segment(self, picture: np.ndarray) -> SegmentMap:
        return self.twist(picture)


def segment_and_scribble(picture: np.ndarray) -> SegmentMap:
    segments = right_segments(picture)
    picture[0, 0] = 0
    return segments


def segment_each_pixel(picture: np.ndarray) -> SegmentMap:
    return SegmentMap(np.arange(to_grey(picture).size, dtype=np.int32).reshape(picture.shape[:2]))


TEXTURE: dict[str, Callable[[np.ndarray], SegmentMap]] = {
    "labels_are_well_formed": lambda picture: SegmentMap(right_segments(picture).labels * 2),
    "two_textures_are_told_apart": segment_each_pixel,
    "same_picture_same_labels": lambda picture: SegmentMap(np.full(picture.shape[:2], next(ticket), np.int32)),
    "picture_is_not_written_to": segment_and_scribble,
    "one_colour_is_one_segment": segment_each_pixel,
    "every_picture_type_is_segmented": lambda picture: right_segments(np.where(picture > 180, picture, 0)),
    "any_size_is_segmented": lambda picture: SegmentMap(right_segments(picture).labels[:8]),
    "what_is_no_picture_is_refused": lambda picture: right_segments(np.nan_to_num(picture)),
}


Law = Callable[[HapticSurface, HapticState], Force]


def spring(surface: HapticSurface, state: HapticState) -> Force:
    """Return k d (-g, 1) on the bilinear interpolant of the heights."""
    if not all(abs(part) < 1 for part in state.position_m):
        return NO_FORCE
    x, y, z = state.position_m
    height, across, along = bilinear(surface, x, y)
    push = 500.0 * (height - z)
    return Force(-across * push, -along * push, push) if push > 0 else NO_FORCE


def bilinear(surface: HapticSurface, x: float, y: float) -> tuple[float, float, float]:
    (width, length), (rows, columns) = surface.relief.pitch_m, surface.height_m.shape
    row = np.clip(rows / 2 - y / length, 0, rows) + 0.5
    column = np.clip(columns / 2 + x / width, 0, columns) + 0.5
    i, j = min(int(row), rows), min(int(column), columns)
    down, right = row - i, column - j
    (a, b), (c, d) = np.pad(surface.height_m.astype(float), 1, "edge")[i : i + 2, j : j + 2]
    far, near = a + right * (b - a), c + right * (d - c)
    return far + down * (near - far), ((b - a) * (1 - down) + (d - c) * down) / width, (far - near) / length


class LawTouch(Touch):
    """A touch whose path can be wrong, unlike that of a `PlainTouch`."""

    def __init__(self, surface: HapticSurface, render: "Render") -> None:
        self.surface, self.law, self.gain_on_a_path = surface, render.law, render.gain_on_a_path
        self.stiffness_n_per_m = render.said_n_per_m

    def force(self, state: HapticState) -> Force:
        return self.law(self.surface, state)

    def path(self, positions_m: np.ndarray, period_s: float = 0.001) -> np.ndarray:
        forces = [self.force(HapticState(tuple(each))) for each in positions_m.tolist()]
        return np.array(forces).reshape(-1, 3) * self.gain_on_a_path


class Render(ForceRenderer):
    law: Law = spring
    gain_on_a_path: float = 1.0
    said_n_per_m: float | None = 500.0

    def touch(self, surface: HapticSurface) -> Touch:
        return LawTouch(surface, self)


def spring_with(change: Callable[..., Force]) -> Render:
    """Return the spring with its force in contact spring_with by `change(x, y, z, surface)`."""

    def law(surface: HapticSurface, state: HapticState) -> Force:
        force = spring(surface, state)
        return force if force == NO_FORCE else change(*force, surface)

    return Render(law=law)


def mirrored_spring(surface: HapticSurface, state: HapticState) -> Force:
    x, y, z = state.position_m
    force = spring(surface, HapticState((x, -y, z)))
    return Force(force.x, -force.y, force.z)


def plane_spring(surface: HapticSurface, state: HapticState) -> Force:
    return Force(0.0, 0.0, max(500.0 * (0.01 - state.position_m[2]), 0.0))


def spring_that_wears(surface: HapticSurface, state: HapticState) -> Force:
    surface.height_m.base[0, 0] += 0.001
    return spring(surface, state)


last = [0.0]


def spring_with_memory(surface: HapticSurface, state: HapticState) -> Force:
    force = spring(surface, state)
    last[0], before = force.z, last[0]
    return Force(force.x, force.y, force.z + before)


def spring_on_bumps(surface: HapticSurface, state: HapticState) -> Force:
    return spring(surface, state) if surface.height_m[1:, 1:].any() else Force(0.0, 0.0, float("nan"))


RENDER: dict[str, Render] = {
    "free_air_is_free": Render(law=lambda surface, state: Force(0.0, 0.0, spring(surface, state).z + 0.01)),
    "plane_pushes_straight_up": spring_with(lambda x, y, z, surface: Force(x + 0.1 * z, y, z)),
    "surface_lies_where_it_is_drawn": Render(law=mirrored_spring),
    "slopes_push_downhill": spring_with(lambda x, y, z, surface: Force(-x, -y, z)),
    "springs_are_exact": spring_with(lambda x, y, z, surface: Force(0.0, 0.0, z)),
    "what_it_says_of_itself_is_felt": Render(law=lambda surface, state: NO_FORCE),
    "resampling_feels_the_same": spring_with(lambda x, y, z, surface: Force(x, y, z * surface.height_m.shape[0])),
    "broken_state_gives_no_force": Render(law=lambda surface, state: Force(0.0, 0.0, 1.0)),
    "path_is_force_by_force": Render(gain_on_a_path=1.1),
    "same_path_same_forces": spring_with(lambda x, y, z, surface: Force(x, y, z * next(ticket))),
    "touches_are_apart": Render(law=spring_with_memory),
    "surface_is_not_written_to": Render(law=spring_that_wears),
    "forces_are_always_finite": Render(law=plane_spring),
    "any_surface_is_taken": Render(law=spring_on_bumps),
    "materials_are_taken": spring_with(lambda x, y, z, surface: Force(x, y, -z if surface.materials else z)),
    "stiffness_is_no_less_than_felt": Render(said_n_per_m=400.0),
}


class GadgetLink(Link):
    def __init__(self, fault: str) -> None:
        super().__init__("the gadget", 2.0 if fault == "forces_are_limited" else 8.0)
        self.fault, self.held, self.ticks = fault, NO_FORCE, 0

    def _read(self) -> HapticState:
        self.ticks += self.fault != "states_make_sense"
        drift = 0.1 if self.fault == "velocity_is_that_of_the_positions" else 0.0
        return HapticState((0.0, 0.0, 0.01), (drift, 0.0, 0.0), self.ticks / 1000)

    def _send(self, force: Force) -> None:
        if force == NO_FORCE and self.fault in ("no_force_is_left_behind", "broken_force_is_none"):
            return
        self.held = Force(0.5 * force.x, 0.5 * force.y, 0.5 * force.z) if self.fault == "force_is_applied" else force

    @property
    def applied(self) -> Force:
        return self.held

    def _release(self) -> None:
        if self.fault == "close_is_final":
            self.held = Force(0.0, 0.0, 1.0)


class Gadget(HapticDevice):
    fault: str = ""

    def spec(self) -> DeviceSpec:
        axes = 7 if self.fault == "spec_makes_sense" else 3
        return DeviceSpec(8.0, 3000.0, 20.0, (0.08, 0.08, 0.08), 1e-4, axes)

    def follows(self, channel: str) -> bool:
        return self.fault == "no_strange_channel_is_followed"

    def open(self) -> Link:
        if self.fault == "device_can_be_opened_again" and next(ticket) % 2:
            raise DeviceError("in use")
        if self.fault == "absence_is_said":
            raise DeviceAbsent("gone")
        return the_only_one if self.fault == "openers_do_not_share" else GadgetLink(self.fault)


the_only_one = GadgetLink("openers_do_not_share")


class Note(Exporter):
    """An exporter of a line of text, with the fault that `fault` names."""

    needs: ClassVar[tuple[str, ...]] = ("relief", "simplified")
    fault: str = ""

    def picture_width_m(self, aspect: float) -> float | None:
        return float("nan") if self.fault == "width_is_a_length" else 0.1 * aspect if 0.1 < aspect < 10 else None

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        text, path = f"{work.title}: {work.relief.height_m.max()} {work.names}", stem.with_suffix(".txt")
        if self.fault == "reads_more":
            text += str(work.parts)
        if self.fault == "nothing_else_is_left":
            Path("notes.txt").write_text("outside")
        if self.fault == "leaves_a_draft":
            stem.with_suffix(".draft").write_text("inside")
        if self.fault == "same_work_same_files":
            text += str(next(ticket))
        if self.fault == "says_the_day":
            text += f"{datetime.now():%Y-%m-%d}"
        if self.fault == "work_is_not_written_to":
            work.picture[0, 0] = 255 - work.picture[0, 0]
        if self.fault == "every_work_is_answered" and work.simplified is None:
            raise AttributeError("labels")
        if self.fault == "every_picture_type_is_taken" and work.picture.dtype == np.uint16:
            return ()
        path.write_text("" if self.fault == "is_empty" else text, "ascii" if self.fault == "ascii" else "utf-8")
        return (path,)


class NeedsATouch(Note):
    needs: ClassVar[tuple[str, ...]] = ("relief", "simplified", "touch")


EXPORT: dict[str, Exporter] = {
    **{check.__name__: Note(fault=check.__name__) for check in kinds.export.CHECKS},
    "needs_are_products": NeedsATouch(),
    "plain_scene_is_written": Note(fault="reads_more"),
}


FAMILIES: list[tuple[Any, Any, dict[str, Any]]] = [
    (kinds.depth.CHECKS, Depth(), {name: Depth(twist=twist) for name, twist in DEPTH.items()}),
    (kinds.texture.CHECKS, Texture(), {name: Texture(twist=twist) for name, twist in TEXTURE.items()}),
    ((*kinds.render.CHECKS, *kinds.touch.CHECKS), Render(), RENDER),
    (kinds.device.CHECKS, Gadget(), {check.__name__: Gadget(fault=check.__name__) for check in kinds.device.CHECKS}),
    (kinds.export.CHECKS, Note(), EXPORT),
]
RIGHT = [pytest.param(check, right, id=check.__name__) for checks, right, _ in FAMILIES for check in checks]
WRONG = [
    pytest.param(check, wrong.get(check.__name__), id=check.__name__)
    for checks, _, wrong in FAMILIES
    for check in checks
    if check is not kinds.depth.nan_is_refused  # no method can fail it: Views lets no NaN through
]


@pytest.mark.parametrize(("check", "method"), RIGHT)
def test_check_correct_method_passes(check, method):
    check(method)


def test_one_view_check_wrong_needs_pair_fails():
    class Silent(DepthEstimator):
        def estimate(self, views: Views) -> DisparityMap:
            return right_depth(views)

    class Boasts(DepthEstimator):
        needs_pair: ClassVar[bool] = True

        def estimate(self, views: Views) -> DisparityMap:
            return DisparityMap(np.zeros(views.shape, np.float32), unit="relative")

    for method, says in ((Silent(), "write `needs_pair"), (Boasts(), "leave that out")):
        with pytest.raises(CheckFailure, match=says):
            kinds.depth.one_view_is_answered(method)


@pytest.mark.parametrize(("check", "method"), WRONG)
@pytest.mark.usefixtures("unchecked_shapes")
def test_check_faulty_method_fails(check, method):
    with pytest.raises((CheckFailure, DeviceError, BrokenMethod)):
        check(method)


@pytest.mark.parametrize(
    ("fault", "check"),
    [
        ("is_empty", kinds.export.plain_scene_is_written),
        ("leaves_a_draft", kinds.export.nothing_else_is_left),
        ("says_the_day", kinds.export.same_work_same_files),
        ("ascii", kinds.export.every_work_is_answered),
    ],
)
def test_export_check_exporter_with_other_fault_fails(fault, check):
    with pytest.raises(CheckFailure):
        check(Note(fault=fault))


CUT = {
    ".json": b'{"low_mm": NaN}',
    ".svg": b"<svg><path/>",
    ".png": b"\x89PNG\r\n\x1a\n",
    ".3mf": b"PK\x03\x04",
    ".stl": bytes(80) + b"\x02\0\0\0" + bytes(50),
    ".glb": b"glTF\x02\0\0\0\xff\0\0\0",
    ".pdf": b"%PDF-1.7 ...",
    ".txt": b"\xff",
}


@pytest.mark.parametrize("ending", CUT)
def test_demand_whole_truncated_file_fails(tmp_path, ending):
    path = tmp_path / f"cut{ending}"
    path.write_bytes(CUT[ending])
    with pytest.raises(Exception, match=r"."):
        demand_whole(path)
