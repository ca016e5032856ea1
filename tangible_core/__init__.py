"""Tangible Images: turn pictures into something one can feel.

The names below are fixed: other people's programs call them. Each is imported when first used, so that
`tangible --help` does not wait for numpy.
"""

from typing import TYPE_CHECKING

from .lazily import lazily
from .provenance.watching import watch_numba

if TYPE_CHECKING:
    from .compiled.touch import CompiledTouch as CompiledTouch
    from .data import Calibration as Calibration
    from .data import DeviceSpec as DeviceSpec
    from .data import DisparityMap as DisparityMap
    from .data import Force as Force
    from .data import HapticState as HapticState
    from .data import HapticSurface as HapticSurface
    from .data import Material as Material
    from .data import MaterialMap as MaterialMap
    from .data import Outcome as Outcome
    from .data import Plan as Plan
    from .data import Relief as Relief
    from .data import SegmentMap as SegmentMap
    from .data import Views as Views
    from .data import Work as Work
    from .errors import TangibleError as TangibleError
    from .pipeline.output.runs import Run as Run
    from .pipeline.output.showing import show as show
    from .pipeline.pipeline import Pipeline as Pipeline
    from .pipeline.pipeline import load_pipeline as load_pipeline
    from .plugins.hooks import hookimpl as hookimpl
    from .plugins.interfaces import DepthEstimator as DepthEstimator
    from .plugins.interfaces import Exporter as Exporter
    from .plugins.interfaces import ForceRenderer as ForceRenderer
    from .plugins.interfaces import HapticDevice as HapticDevice
    from .plugins.interfaces import Link as Link
    from .plugins.interfaces import PlainTouch as PlainTouch
    from .plugins.interfaces import Segmenter as Segmenter
    from .plugins.interfaces import Skippable as Skippable
    from .plugins.interfaces import Touch as Touch
    from .plugins.registry import load_method as load_method
    from .scene.rig import Camera as Camera
    from .scene.rig import StereoRig as StereoRig
    from .scene.scene import Scene as Scene
    from .scene.workspace import Workspace as Workspace
    from .session.recording import Recording as Recording

__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "compiled.touch": ["CompiledTouch"],
        "data": [
            "Calibration", "DeviceSpec", "DisparityMap", "Force", "HapticState", "HapticSurface", "Material",
            "MaterialMap", "Outcome", "Plan", "Relief", "SegmentMap", "Views", "Work",
        ],
        "errors": ["TangibleError"],
        "pipeline.pipeline": ["Pipeline", "load_pipeline"],
        "pipeline.output.runs": ["Run"],
        "pipeline.output.showing": ["show"],
        "plugins.hooks": ["hookimpl"],
        "plugins.interfaces": [
            "DepthEstimator", "Exporter", "ForceRenderer", "HapticDevice", "Link", "PlainTouch", "Segmenter",
            "Skippable", "Touch",
        ],
        "plugins.registry": ["load_method"],
        "scene.rig": ["Camera", "StereoRig"],
        "scene.scene": ["Scene"],
        "scene.workspace": ["Workspace"],
        "session.recording": ["Recording"],
    },
)  # fmt: skip

watch_numba()
