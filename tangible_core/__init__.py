"""Tangible Images: turn pictures into something one can feel.

The names below are for users of pipelines; `tangible_core.plugins` has those for authors of plugins. Each is imported
on first use, so that `tangible --help` does not wait for numpy.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .lazily import lazily
from .provenance.watching import watch_numba

if TYPE_CHECKING:
    from .data import Calibration as Calibration
    from .data import DisparityMap as DisparityMap
    from .data import Force as Force
    from .data import HapticState as HapticState
    from .data import HapticSurface as HapticSurface
    from .data import Material as Material
    from .data import MaterialMap as MaterialMap
    from .data import Relief as Relief
    from .data import SegmentMap as SegmentMap
    from .data import Views as Views
    from .errors import TangibleError as TangibleError
    from .pipeline.feeling import Feeling as Feeling
    from .pipeline.output.runs import Run as Run
    from .pipeline.output.showing import show as show
    from .pipeline.pipeline import Pipeline as Pipeline
    from .pipeline.pipeline import load_pipeline as load_pipeline
    from .plugins.registry import load_method as load_method
    from .scene.rig import Camera as Camera
    from .scene.rig import StereoRig as StereoRig
    from .scene.scene import Scene as Scene
    from .scene.workspace import Workspace as Workspace
    from .session.recording import Recording as Recording

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "data": [
            "Calibration", "DisparityMap", "Force", "HapticState", "HapticSurface", "Material",
            "MaterialMap", "Relief", "SegmentMap", "Views",
        ],
        "errors": ["TangibleError"],
        "pipeline.feeling": ["Feeling"],
        "pipeline.output.runs": ["Run"],
        "pipeline.output.showing": ["show"],
        "pipeline.pipeline": ["Pipeline", "load_pipeline"],
        "plugins.registry": ["load_method"],
        "scene.rig": ["Camera", "StereoRig"],
        "scene.scene": ["Scene"],
        "scene.workspace": ["Workspace"],
        "session.recording": ["Recording"],
    },
)  # fmt: skip

watch_numba()
