"""What is said when kernels are compiled."""

import logging
from types import SimpleNamespace

from tangible_render.compile_notice import _CompileNotice


def test_compiling_the_laws_is_said_once_and_other_kernels_are_not_ours(caplog):
    def event(module: str) -> SimpleNamespace:
        return SimpleNamespace(data={"dispatcher": SimpleNamespace(py_func=SimpleNamespace(__module__=module))})

    notice = _CompileNotice()
    with caplog.at_level(logging.WARNING):
        for module in ("numpy.linalg", "tangible_render.spline", "tangible_render.closest"):
            notice.on_start(event(module))
            notice.on_end(event(module))
    assert [record.message for record in caplog.records] == [
        "compiling the force laws for this processor; the next process finds them on disk"
    ]
