"""What is said when kernels are compiled."""

import logging
from types import SimpleNamespace

from tangible_core.compiled.compiling import _CompileNotice


def test_compiling_is_said_once_a_family_and_other_kernels_are_not_ours(caplog):
    notice = _CompileNotice()
    with caplog.at_level(logging.INFO):
        for module in (
            "numpy.linalg",
            "tangible_render.surface.spline",
            "tangible_render.contact.closest",
            "tangible_depth.sgm.aggregation",
        ):
            event = SimpleNamespace(data={"dispatcher": SimpleNamespace(py_func=SimpleNamespace(__module__=module))})
            notice.on_start(event)
            notice.on_end(event)
    assert {record.levelname for record in caplog.records} == {"INFO"}, "it is routine, and no warning"
    assert [record.message for record in caplog.records] == [
        "compiling the render kernels for this processor, about 2 s; later runs find them on disk",
        "compiling the depth kernels for this processor, about 8 s; later runs find them on disk",
    ]
