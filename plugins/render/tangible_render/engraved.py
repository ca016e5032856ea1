"""Contours as valleys: a groove along each border between parts, carved into the surface of another force law."""

import logging
from functools import partial
from typing import Annotated, ClassVar

import numpy as np
from jaxtyping import Float32
from pydantic import AfterValidator, Field

from tangible_core.data import HapticSurface, Relief
from tangible_core.plugins import ForceRenderer, Reshaping, Touch, note

from .borders import border_distance
from .effects.inner_law import Law, build_law, complete_options

log: logging.Logger = logging.getLogger(__name__)
# The least cells across a groove: with fewer, a cubic spline changes its section.
FEWEST_CELLS = 6


def _refusal(cls: type[ForceRenderer]) -> str:
    return "already wraps a force law; name the inner force law itself" if cls is Engraved else ""


_COMPLETE = AfterValidator(partial(complete_options, refusal=_refusal))


class Engraved(ForceRenderer, Reshaping):
    """A groove along every border between the parts of a surface, or its segments, under any other law.

    The heights become h - D (1 + cos(2 pi d / W)) / 2 where the distance d to the nearest border is less than W / 2,
    with D the depth and W the width of the groove: a valley without edges. Only the surface changes, so that the result
    is as conservative as the inner force law. The borders are smooth lines within half a cell of those of the labels
    (see `borders`), so that a surface with twice the cells feels the same.

    No height may be less than 0: where the ground is too low for a groove, the whole surface is raised by the missing
    height, at most D, and a note reports it. Of several near borders the nearest counts: a part narrower than W is all
    groove. Friction, texture and damping are those of the inner force law; to add them to one without, use
    {use: with-materials, law: ...}.
    Source: the raised cosine as an engraved line is our convention; valleys guide a finger along a contour:
    Yu & Brewster, Multimodal virtual reality versus printed medium in visualization for blind people, ASSETS 2002.
    """

    renders_materials: ClassVar[bool] = True
    why_still: ClassVar[str] = "its grooves lie along borders, which would have to be found and followed in each frame"

    law: Annotated[Law, _COMPLETE, Field(validate_default=True)] = "proxy"
    """The inner force law, which renders the grooves: its name, or {use: its name} with its options."""
    width_m: Annotated[float, Field(gt=0, le=0.05, allow_inf_nan=False)] = 0.003
    """Width of a groove, from edge to edge."""
    depth_m: Annotated[float, Field(gt=0, le=0.01, allow_inf_nan=False)] = 0.0006
    """Depth of a groove in its middle."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return the inner force law's touch on the surface with grooves, or unchanged if it has no borders."""
        _, law = build_law(self.law, _refusal)
        return law.touch(self.felt(surface))

    def felt(self, surface: HapticSurface) -> HapticSurface:
        """Return the surface with a groove along each border between its labels, as the inner force law gets it."""
        labels = surface.labels
        if labels is None or (labels == labels[0, 0]).all():
            note(log, "no groove is engraved: the surface has no borders between parts or segments")
            return surface
        if self.width_m < FEWEST_CELLS * (pitch_m := max(surface.relief.pitch_m)):
            note(
                log,
                f"a groove of {1000 * self.width_m:.2g} mm is {self.width_m / pitch_m:.2g} cells wide and will feel "
                f"shallower than specified; this grid holds {1000 * FEWEST_CELLS * pitch_m:.2g} mm or more",
                logging.WARNING,
            )
        lower_m = self.section(border_distance(labels, surface.relief.pitch_m, self.width_m / 2))
        height_m = surface.height_m - lower_m
        lift_m = max(0.0, -float(height_m.min()))
        if lift_m > 0:
            note(log, f"the surface is raised by {1000 * lift_m:.2g} mm, so that its grooves stay above the base")
        carved_m = np.maximum(height_m + np.float32(lift_m), np.float32(0.0))
        return HapticSurface(Relief(carved_m, surface.extent_m), labels, surface.materials, surface.names)

    def section(self, distance_m: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Return the depth of the groove, m, at these distances from a border."""
        turn = 2 * np.pi * np.minimum(distance_m / self.width_m, 0.5)
        return np.float32(0.5 * self.depth_m) * (1 + np.cos(turn, dtype=np.float32))
