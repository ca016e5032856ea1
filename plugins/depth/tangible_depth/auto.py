"""Method `auto`: the method that suits the scene and the installed networks."""

import logging
from collections.abc import Callable
from pathlib import Path

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator, Following, note
from tangible_networks.store import networks_here

from .luminance import Luminance
from .onnx import Onnx
from .semi_global import SemiGlobal

log: logging.Logger = logging.getLogger(__name__)


class Auto(DepthEstimator, Following):
    """A pair is matched by `semi-global`; one picture goes to a network if there is one, otherwise to `luminance`.

    A network is an ONNX file next to its card, a YAML file of the same name, in the folder `models` of the user's data
    or in the folder of the environment variable TANGIBLE_MODELS_DIR; of several for one picture, the first by name.
    Without one, lighter is nearer, which is not depth, and a warning is logged.

    Source: that of the chosen method.
    """

    @property
    def finds_depth(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride] - it depends on the folder
        """True where there is a network: of a pair, depth is found by all methods."""
        return _network() is not None

    def reads(self) -> tuple[Path, ...]:
        """Return the network and its card; empty without a network."""
        network = _network()
        return () if network is None else network.reads()

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate by the chosen method. Raises: as that method."""
        return self._choose(views).estimate(views)

    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """Follow by the chosen method; a pair is matched as a preview, at half the size."""
        if views.right is not None:
            return SemiGlobal(resolution="half").follow(views)
        return self._choose(views).estimate

    def _choose(self, views: Views) -> DepthEstimator:
        if views.right is not None:
            note(log, "a pair: matched by semi-global")
            return SemiGlobal()
        network = _network()
        if network is not None:
            note(log, f"one picture: its depth is estimated by the network {network.model}")
            return network
        note(
            log,
            "one picture contains no depth, and there is no network: lighter is taken as nearer, so light and shadow "
            "become relief; draw its parts (`tangible parts`), or install a network (docs/how-to/learned-depth.md)",
            logging.WARNING,
        )
        return Luminance()


def _network() -> Onnx | None:
    for network in networks_here("depth"):
        if not network.card.is_stereo:
            return Onnx(model=network.path, card=str(network.card_file or network.name))
    return None
