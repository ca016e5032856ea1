"""Every check of the kit. Otherwise a method with the fault that a check is there for would pass."""

from typing import Any, ClassVar

import numpy as np
import pytest

from faulty_methods import DEPTH, EXPORT, RENDER, TEXTURE, Depth, Gadget, Note, Render, Texture, right_depth
from tangible_core import DisparityMap, Views
from tangible_core.errors import BrokenMethod, DeviceError
from tangible_core.plugins import DepthEstimator
from tangible_core.testing import CheckFailure, kinds
from tangible_core.testing.kinds.export import demand_whole

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
