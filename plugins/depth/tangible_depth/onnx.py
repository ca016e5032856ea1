"""Method `onnx`: depth by a trained network from the user."""

import logging
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from tangible_core.data import DisparityMap, Views, to_rgb
from tangible_core.errors import ConfigError, ModelAbsent, PictureError, TangibleError
from tangible_core.plugins import DepthEstimator, Skippable, note
from tangible_networks.card import Card, Runtime, check_file, read_card, shipped_cards
from tangible_networks.fitting import Colours, Map, fit_size, map_in_strips, restore_size, tensor, to_disparity
from tangible_networks.runtimes import run

log: logging.Logger = logging.getLogger(__name__)


class Onnx(DepthEstimator, Skippable):
    """A trained network in an ONNX file, for one picture or for a rectified pair; none is shipped or downloaded.

    A card describes the network's input and the meaning of its output: disparity in pixels, inverse depth, depth, or
    metres. From one picture, the result is nearness in 0..1; metres become a disparity if the cameras are known.
    A picture of more than `most_px` pixels is matched in strips of rows if its map is in pixels, and reduced otherwise.

    Source: that of the network, which its card names.
    """

    model: Path | None = None
    """The ONNX file."""
    card: str = ""
    """Description of the network: the name of a shipped card (depth-anything-v2-small, ...), or a YAML file; empty for
    the YAML file next to the model with its name."""
    runtime: Runtime = "opencv"
    """Library that runs the network, unless its card names the only one that can: `opencv` (5 or newer), or
    `onnxruntime` if installed, which can use a GPU; `kornia` is for cards that name it."""
    most_px: Annotated[int, Field(ge=4096, le=100_000_000)] = 600_000
    """Largest number of pixels of the network's input: its memory grows with them."""

    @property
    def needs_pair(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride] - it depends on the network
        """True for a network of two views; False if its card cannot be read."""
        try:
            return self.model is not None and self._card(self.model).is_stereo
        except (TangibleError, OSError):
            return False

    def reads(self) -> tuple[Path, ...]:
        """Return the network and its card."""
        return () if self.model is None else (self.model, *filter(None, [self._card_file(self.model)]))

    def skip(self, views: Views) -> str | None:
        """Return the reason to skip a pair of identical views, which shows no depth."""
        if views.right is not None and self.needs_pair and np.array_equal(views.left, views.right):
            return "both views are identical: there is no depth to find"
        return None

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate disparity in pixels, or nearness of one picture. Raises: ModelAbsent, ConfigError, PictureError."""
        if self.model is None:
            raise ModelAbsent(
                "onnx needs a network from you: depth: {use: onnx, model: FILE.onnx, card: NAME or FILE.yaml}; nothing "
                "is downloaded in a run; `tangible networks` lists those with a card (docs/how-to/learned-depth.md)"
            )
        card = self._card(self.model)
        check_file(self.model, card)
        right = views.right if card.is_stereo else None
        if card.is_stereo and right is None:
            raise PictureError(
                f"{card.title or self.model.name} compares two views, and this scene has one; give a right view, or "
                "use a network for one picture"
            )
        if not card.verified:
            note(log, f"the card of {card.title} was never tested with its network: check that near is high")
        values, sure = self._maps(self.model, card, to_rgb(views.left), None if right is None else to_rgb(right))
        return to_disparity(values, sure, card.output.means, views)

    def _maps(self, model: Path, card: Card, left: Colours, right: Colours | None) -> tuple[Map, Map | None]:
        """Return the network's map and its confidence, if any, in the size of the picture."""
        most_px, (height, width) = self.most_px, left.shape[:2]
        in_pixels = card.output.means == "disparity-px" and card.input.size_px is None
        limit = height * width if in_pixels else most_px

        def work(rows: slice) -> list[Map]:
            views = [view[rows] for view in (left, right) if view is not None]
            if rows.start == 0:  # once: strips are alike
                _note_size(fit_size(views[0].shape[:2], card.input, limit).resized, card.input.trained_px)
            return self._run(model, card, views, limit)

        maps = map_in_strips((height, width), most_px if in_pixels else height * width, card.input.multiple, work)
        return maps[0], maps[1] if len(maps) > 1 else None

    def _run(self, model: Path, card: Card, views: list[Colours], most_px: int) -> list[Map]:
        takes, gives = card.input, card.output
        shape: tuple[int, int] = views[0].shape[:2]
        fit = fit_size(shape, takes, most_px)
        names = (takes.left, takes.right) if len(views) == 2 else (takes.left,)
        inputs = {name: tensor(view, takes, fit) for name, view in zip(names, views, strict=True)}
        inputs |= {name: np.array(number, np.int64) for name, number in takes.constants.items()}
        output_names = [gives.name, *filter(None, (gives.confidence, gives.normals))]
        arrays = run(model, card.runtime or self.runtime, inputs, output_names)
        outputs = dict(zip(output_names, arrays, strict=True))
        if gives.normals:
            from tangible_networks.normals import join_normals  # imports scipy

            points, normals, sure = outputs[gives.name], outputs.pop(gives.normals), outputs.get(gives.confidence)
            size = points.shape[-3:-1]
            if not points.shape == normals.shape == (1, *size, 3) or (sure is not None and sure.size != np.prod(size)):
                raise ConfigError(
                    f"model: {model} returns points of {points.shape} and normals of {normals.shape}; both must be "
                    "(1, height, width, 3), and a confidence as large; name other outputs in the card"
                )
            outputs[gives.name] = join_normals(points[0], normals[0], None if sure is None else sure.reshape(size))
        maps: list[Map] = []
        for name, output in outputs.items():
            values = restore_size(output, fit, shape, gives.channel if name == gives.name else None)
            if values is None:
                raise ConfigError(
                    f"model: {model} returns {name or 'an output'} of {output.shape}, which is not a map; name another "
                    "output in the card"
                )
            maps.append(values)
        if gives.means == "disparity-px":
            maps[0] = maps[0] * np.float32(shape[1] / fit.resized[1])
        return maps

    def _card(self, model: Path) -> Card:
        file = self._card_file(model)
        if file and not self.card and not file.is_file():
            raise ConfigError(
                f"{model}: has no card, which says what the network takes and gives; write `card: NAME`, one of "
                f"{', '.join(shipped_cards())}, or describe it in {file.name} (docs/how-to/learned-depth.md)"
            )
        return read_card(file or self.card)

    def _card_file(self, model: Path) -> Path | None:
        """Return the card's file; None for a shipped card. A relative file may also lie next to the network."""
        if self.card in shipped_cards():
            return None
        path = Path(self.card) if self.card else model.with_suffix(".yaml")
        next_to_model = model.parent / path
        return next_to_model if next_to_model.is_file() else path


# Ratio of sides from which a network sees things much larger or smaller than those it was trained with.
FAR = 1.4


def _note_size(size: tuple[int, int], trained_px: tuple[int, int] | None) -> None:
    if trained_px is None:
        return
    ratio = (size[0] * size[1] / (trained_px[0] * trained_px[1])) ** 0.5
    if not 1 / FAR <= ratio <= FAR:
        note(
            log,
            f"the network was trained with pictures of {trained_px[0]} x {trained_px[1]} pixels and sees this one at "
            f"{size[0]} x {size[1]}; if near and far are confused, try `most_px: {trained_px[0] * trained_px[1]}`",
        )
