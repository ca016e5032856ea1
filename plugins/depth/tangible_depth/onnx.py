"""Method `onnx`: depth by a trained network that the user brings."""

import logging
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from tangible_core.data import DisparityMap, Views
from tangible_core.data.pictures import to_rgb
from tangible_core.errors import ConfigError, ModelAbsent, PictureError, TangibleError
from tangible_core.plugins.interfaces import DepthEstimator, Skippable
from tangible_core.plugins.notes import note

from .network.card import PRESETS, Card, check_file, read_card
from .network.conversion import to_disparity
from .network.fitting import Colours, Map, cut_back, fit_for, in_strips, tensor
from .network.runtimes import Runtime, run

log = logging.getLogger(__name__)


class Onnx(DepthEstimator, Skippable):
    """A trained network in an ONNX file, for one picture or for a rectified pair; none is shipped or downloaded.

    A card says what the network takes and what its numbers mean: disparity in pixels, inverse depth, depth, or metres.
    From one picture, what comes out is nearness in 0..1; metres become a disparity where the cameras are known.
    A picture of more than `most_px` pixels is matched in strips of rows if its map is in pixels, and reduced otherwise.

    Source: that of the network, which its card names.
    """

    model: Path | None = None
    """The ONNX file."""
    card: str = ""
    """What the network takes and gives: the name of a card that is shipped (depth-anything-v2-small, ...), or a YAML
    file; empty for the YAML file of the model's name beside it."""
    runtime: Runtime = "opencv"
    """What runs it: `opencv` (5 or newer), or `onnxruntime` where that is installed, which uses a graphics card."""
    most_px: Annotated[int, Field(ge=4096, le=100_000_000)] = 600_000
    """Most pixels that the network sees at once: memory grows with them."""

    @property
    def needs_pair(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride] - it depends on the network
        """Whether the network takes two views, as far as its card can be read."""
        try:
            return self.model is not None and self._card(self.model).is_stereo
        except (TangibleError, OSError):
            return False

    def reads(self) -> tuple[Path, ...]:
        """The network and its card."""
        return () if self.model is None else (self.model, *filter(None, [self._card_file(self.model)]))

    def skip(self, views: Views) -> str | None:
        """Two views that are identical show no depth to a network that compares them."""
        if views.right is not None and self.needs_pair and np.array_equal(views.left, views.right):
            return "both views are identical: there is no depth to find"
        return None

    def estimate(self, views: Views) -> DisparityMap:
        """Disparity in pixels, or nearness from one picture; NaN where the network gives no number.

        Raises: ModelAbsent if the network is not there, ConfigError for a card or a network that does not fit,
        PictureError without the right view that it needs.
        """
        if self.model is None:
            raise ModelAbsent(
                "onnx needs a network of your own: depth: {use: onnx, model: FILE.onnx, card: NAME or FILE.yaml}; "
                f"nothing is downloaded; cards are there for {', '.join(PRESETS)} (docs/learned-depth.md)"
            )
        card = self._card(self.model)
        check_file(self.model, card)
        if card.is_stereo and views.right is None:
            raise PictureError(
                f"{card.title or self.model.name} compares two views, and this scene has one; give a right view, or "
                "use a network for one picture"
            )
        if not card.verified:
            note(log, f"the card of {card.title} was never tried with its network: look whether near is high")
        found, sure = self._maps(self.model, card, to_rgb(views.left), _right(views, card))
        return to_disparity(found, sure, card.output.means, views)

    def _maps(self, model: Path, card: Card, left: Colours, right: Colours | None) -> tuple[Map, Map | None]:
        """What the network gives, and how sure it is of it, in the size of the picture."""
        most_px, (height, width) = self.most_px, left.shape[:2]
        in_pixels = card.output.means == "disparity-px" and card.input.size_px is None
        limit = height * width if in_pixels else most_px

        def work(rows: slice) -> list[Map]:
            views = [each[rows] for each in (left, right) if each is not None]
            return self._run(model, card, views, limit)

        maps = in_strips((height, width), most_px if in_pixels else height * width, card.input.multiple, work)
        return maps[0], maps[1] if len(maps) > 1 else None

    def _run(self, model: Path, card: Card, views: list[Colours], most_px: int) -> list[Map]:
        takes, gives = card.input, card.output
        shape: tuple[int, int] = views[0].shape[:2]
        fit = fit_for(shape, takes, most_px)
        names = (takes.left, takes.right) if len(views) == 2 else (takes.left,)
        inputs = {name: tensor(view, takes, fit) for name, view in zip(names, views, strict=True)}
        wanted = [gives.name, gives.confidence] if gives.confidence else [gives.name]
        found = run(model, self.runtime, inputs, wanted)
        maps: list[Map] = []
        for name, each in zip(wanted, found, strict=True):
            values = cut_back(each, fit, shape)
            if values is None:
                raise ConfigError(
                    f"model: {model} gives {name or 'an output'} of {each.shape}, which is no map; name another output "
                    "in the card"
                )
            maps.append(values)
        if gives.means == "disparity-px":
            maps[0] = maps[0] * np.float32(shape[1] / fit.resized[1])
        return maps

    def _card(self, model: Path) -> Card:
        return read_card(self._card_file(model) or self.card)

    def _card_file(self, model: Path) -> Path | None:
        """Where the card stands; None for one that is shipped. A relative file is looked for beside the network too."""
        if self.card in PRESETS:
            return None
        named = Path(self.card) if self.card else model.with_suffix(".yaml")
        beside = model.parent / named
        return beside if beside.is_file() else named


def _right(views: Views, card: Card) -> Colours | None:
    return to_rgb(views.right) if card.is_stereo and views.right is not None else None
