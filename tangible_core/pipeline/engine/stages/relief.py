"""The relief: from the disparity, or with `heights:` from the parts."""

import logging
from functools import cached_property

import numpy as np
from jaxtyping import Float32, Int32

from ....data import Calibration, DisparityMap, PartMap, Relief
from ....drawing import PictureKind, kind_sentence
from ....parts import Layering, PartHeights
from ....plugins.interfaces import Hierarchical
from ....plugins.notes import note
from ....relief import (
    ReliefChoice,
    ReliefScale,
    edge_relief,
    edges,
    figure,
    figure_relief,
    line_relief,
    lines,
    relief_scale,
    shape_relief,
    shaping,
)
from ....scene import geometry, scaling
from ....scene.workspace import FeltSize, flat_warning
from .. import part_heights
from ..hooked import look_function, networks_identity
from ..part_heights import warn_missing_heights
from ..stage import Inputs, Stage, method_identity
from ..working_grid import flatten_transparent, relief_of_layers

log: logging.Logger = logging.getLogger(__name__)
SPREAD = "heights are spread so that borders can be felt; `relief: depth` keeps true proportions"
LEVEL, MAX_REGIONS = 0.6, 64
"""The least share of people who would draw a border that is a raised line, and the most regions between such lines. On
20 photographs, lines at this level are at drawn borders as often as lines at edges, and find more of these."""
SEEN_LEVEL = 0.4
"""The least share where the method has a network, whose borders are surer: of .3 to .6, that whose lines lie best at
the borders that people drew in 30 photographs."""
LINEAR = ReliefChoice(by="depth", slope=0, grain_m=0)


class ReliefStage(Stage):
    """Make heights in metres of the disparity, or of the heights of parts."""

    product = "relief"

    @property
    def needs(self) -> tuple[str, ...]:
        heights = self.config.heights
        if heights is None:
            figure_needs = ("figure",) if self.config.relief_kind == "figure" else ()
            return "views", *figure_needs, *(("disparity",) if self._takes_depth else ())
        by_depth = ("disparity",) if heights.by == "depth" else ()
        return "views", self.config.felt_parts, *by_depth

    @cached_property
    def size(self) -> FeltSize:
        """The decided workspace, once: a depth method may look into a folder for it, and a film has many frames."""
        return self.config.size

    @cached_property
    def key(self) -> str:
        config, size = self.config, self.size
        if config.heights is None:
            if config.relief_kind == "figure":
                return f"{self.code(figure.__name__)} {size!r} {self.choice!r}{self.reduction}"
            if config.relief_kind == "lines":
                kind = self.context.scene.stated_kind
                return f"{self.code(lines.__name__)} {size!r} {self.choice!r}{self.reduction} {kind}"
            if config.relief_kind != "edges":
                return f"{self.code(shaping.__name__)} {size!r} {self.choice!r}{self.reduction}"
            source = method_identity(config.texture)[1] if self._divider else self._network
            return f"{self.code(edges.__name__)} {size!r} {self.choice!r}{self.reduction} {source}"
        code = self.code(part_heights.__name__, Layering.__module__, geometry.__name__)
        return f"{code} {size!r} {config.heights!r} {sorted(config.given_heights_m.items())}{self.reduction}"

    @cached_property
    def choice(self) -> ReliefChoice:
        """The decided shape, once, as the size; the brightness of a photograph is scaled and smoothed only."""
        return LINEAR if self.config.relief_kind == "photograph" else self.config.relief

    @property
    def note(self) -> str:
        heights = self.config.heights
        if heights is None and self.config.relief_kind == "edges":
            if self._network or self._divider is not None:
                return "no depth is needed: borders that people would draw are raised lines"
            return "no depth is needed: edges are raised lines"
        if heights is None and self.config.relief_kind == "figure":
            if self._takes_depth:
                return "the figure is raised, and its depth shapes it"
            return "no depth is needed: the figure is raised and rounded"
        if heights is None and self.config.relief_kind == "lines":
            return "no depth is needed: lines are raised"
        if heights is None or heights.by == "depth":
            return ""
        return f"no depth is needed: heights are {'given' if heights.by == 'given' else 'guessed'}"

    def make(self, inputs: Inputs) -> Relief:
        relief = self._make(inputs)
        if text := flat_warning(relief, self.config.relief_kind):
            note(log, text, logging.WARNING)
        return relief

    def _make(self, inputs: Inputs) -> Relief:
        if self.config.heights is not None:
            return self._from_parts(inputs[self.config.felt_parts], inputs.get("disparity"))
        if self.config.relief_kind == "edges":
            relief = edge_relief(self.views, self.size, self.choice, self._regions(), self._borders())
            return flatten_transparent(relief, self.grid.opaque_mask)
        if self.config.relief_kind == "lines":
            return self._from_lines()
        if self.config.relief_kind == "figure":
            disparity = inputs.get("disparity")
            if disparity is not None:
                disparity = scaling.reduced_disparity(disparity, self.grid.shape)
            relief = figure_relief(self.views, inputs["figure"], self.size, self.choice, disparity)
            return flatten_transparent(relief, self.grid.opaque_mask)
        disparity: DisparityMap | None = inputs["disparity"]
        if disparity is None:
            return geometry.flat_relief(self.views.shape, self.size.width_m)
        if self.choice.spread_share or self.choice.most_accent_m:
            note(log, SPREAD)
        return self.from_disparity(scaling.reduced_disparity(disparity, self.grid.shape))

    def _from_lines(self) -> Relief:
        kind = self.context.scene.kind
        areas = kind.kind not in (PictureKind.lines, PictureKind.text)
        relief, texts = line_relief(self.views, self.size, self.choice, areas=areas)
        note(log, kind_sentence(kind))
        if texts:
            note(log, f"letters are left out of the relief, at {texts} places")
        return flatten_transparent(relief, self.grid.opaque_mask)

    def from_disparity(self, disparity: DisparityMap, scale: ReliefScale | None = None) -> Relief:
        """Return the relief of a disparity map on the working grid. scale: as `shape_relief`."""
        relief = shape_relief(disparity, self._calibration, self.size, self.choice, scale)
        return flatten_transparent(relief, self.grid.opaque_mask)

    def scale(self, disparity: DisparityMap) -> ReliefScale:
        """Return the scale of the relief of this disparity map alone."""
        return relief_scale(disparity, self._calibration, self.size.width_m, self.choice)

    @cached_property
    def _network(self) -> str:
        """The code and the identity of the network that sees borders, where the texture method does not; "" without."""
        registry = self.context.registry
        if self._divider is not None or not (identity := networks_identity(registry, "borders")):
            return ""
        return f"{self.code(look_function(registry).__module__)} {identity}"

    def _borders(self) -> Float32[np.ndarray, "h w"] | None:
        """Return how surely people would draw a border at each pixel; None without a network."""
        return look_function(self.context.registry)(self.views.left, ("borders",)).borders if self._network else None

    @property
    def _takes_depth(self) -> bool:
        """True if the relief is made of depth: that of a figure is where a method finds it."""
        kind, depth = self.config.relief_kind, self.config.depth
        return kind not in ("edges", "lines") and (kind != "figure" or (depth is not None and depth.method.finds_depth))

    @property
    def _divider(self) -> Hierarchical | None:
        """The texture method, if it knows how likely people are to draw a border."""
        method = self.config.texture.method if self.config.texture else None
        return method if isinstance(method, Hierarchical) else None

    def _regions(self) -> Int32[np.ndarray, "r c"] | None:
        """Return the regions whose borders are raised lines; None without a method that finds them."""
        if self._divider is None:
            return None
        cells = edges.reduce_to_cells(self.views, self.size.width_m)
        assert self.config.texture is not None
        if not self.config.texture.method.reads():
            return self._divider.tree(cells).cut(MAX_REGIONS, LEVEL).labels
        labels = self._divider.tree(self.views.left).cut(MAX_REGIONS, SEEN_LEVEL).labels  # a network needs all pixels
        return scaling.middle_pixels(labels, cells.shape[:2])

    @property
    def _calibration(self) -> Calibration | None:
        views = self.context.scene.views
        return views.calibration if views else None

    def part_heights(self, parts: PartMap, disparity: DisparityMap | None) -> PartHeights:
        """Return the height of each part, and why. parts, disparity: of any size; both are brought to the grid."""
        config, grid = self.config, self.grid
        assert config.heights is not None
        if disparity is not None:
            disparity = scaling.reduced_disparity(disparity, grid.shape)
        on_grid, given_m = grid.parts(parts, config.felt_parts), config.given_heights_m
        picture = grid.views.left if grid.views else None
        return part_heights.choose_heights(
            on_grid, config.heights, config.top_m, given_m, disparity, grid.opaque_mask, picture
        )

    def _from_parts(self, parts: PartMap, disparity: DisparityMap | None) -> Relief:
        config, grid = self.config, self.grid
        assert config.heights is not None
        views, heights = self.views, self.part_heights(parts, disparity)
        warn_missing_heights(heights, config.heights, config.given_heights_m)
        on_grid = grid.parts(parts, config.felt_parts)
        layering = Layering(on_grid, self.size.width_m, config.heights, views.left)
        return relief_of_layers(layering, heights.heights_m, self.size, grid.opaque_mask)
