"""Method `auto`: what suits the scene and what is there."""

import logging
import os
from collections.abc import Callable
from pathlib import Path

from tangible_core.data import DisparityMap, Views
from tangible_core.errors import TangibleError
from tangible_core.files.paths import as_path
from tangible_core.plugins.interfaces import DepthEstimator, Following
from tangible_core.plugins.notes import note

from .luminance import Luminance
from .onnx import Onnx
from .semi_global import SemiGlobal

log = logging.getLogger(__name__)
VARIABLE = "TANGIBLE_MODELS_DIR"


class Auto(DepthEstimator, Following):
    """A pair is matched by `semi-global`; one picture goes to a network if there is one, and else to `luminance`.

    A network is an ONNX file with its card beside it, a YAML file of the same name, in the folder `models` of the
    user's data or in that of the environment variable TANGIBLE_MODELS_DIR; of several for one picture, the first by
    name. Without one, lighter is nearer, which is no depth, and the result says so.

    Source: that of the method that is taken.
    """

    def reads(self) -> tuple[Path, ...]:
        """The network and its card, where there is one."""
        network = _network()
        return () if network is None else network.reads()

    def estimate(self, views: Views) -> DisparityMap:
        """As the method that is taken. Raises: as that."""
        return self._chosen(views).estimate(views)

    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """As the method that is taken; a pair is matched as a preview, at half the size."""
        if views.right is not None:
            return SemiGlobal(resolution="half").follow(views)
        return self._chosen(views).estimate

    def _chosen(self, views: Views) -> DepthEstimator:
        if views.right is not None:
            note(log, "a pair: matched by semi-global")
            return SemiGlobal()
        network = _network()
        if network is not None:
            note(log, f"one picture: its depth is what the network {network.model} makes of it")
            return network
        note(
            log,
            "one picture holds no depth, and there is no network: lighter is felt as nearer, so light and shadow are "
            "felt; draw its parts (`tangible parts`), or bring a network (docs/learned-depth.md)",
            logging.WARNING,
        )
        return Luminance()


def _network() -> Onnx | None:
    """The first network for one picture."""
    try:
        for model in sorted(_folder().glob("*.onnx")):
            found = Onnx(model=model)
            if model.with_suffix(".yaml").is_file() and not found.needs_pair:
                return found
    except (TangibleError, OSError) as error:
        log.warning("no network is looked for: %s", error)
    return None


def _folder() -> Path:
    if named := os.environ.get(VARIABLE):
        return as_path(named, VARIABLE)
    from platformdirs import user_data_path

    return user_data_path("tangible-images") / "models"
