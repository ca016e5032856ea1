"""The disparity map: by a depth method, from the pictures."""

import logging
from collections.abc import Callable
from functools import cached_property

import numpy as np

from ....data import DisparityMap, Views
from ....errors import PictureError, TangibleError
from ....plugins.notes import doubt, note
from ....scene import pair_checks, scaling
from ....scene.pair_checks import ViewOrder
from ....scene.scene_files import SceneFiles
from ..stage import Inputs, MethodStage, no_picture
from ..working_grid import known_disparity

log: logging.Logger = logging.getLogger(__name__)


class DisparityStage(MethodStage):
    """Estimate the disparity, and correct it where the views are exchanged."""

    product = "disparity"
    kind = "depth"

    @property
    def needs(self) -> tuple[str, ...]:
        return ("views",)

    @cached_property
    def key(self) -> str:
        code = " ".join(self.code(module.__name__) for module in (scaling, pair_checks))
        return f"{code} {self._order_is_given} {self.identity[1]} {self.grid.key}"

    def make(self, inputs: Inputs) -> DisparityMap:
        views = self.views
        estimate = self.estimate(self.required_choice.method.estimate)
        order = self.order(estimate, views)
        if order is not None and order.message:
            note(log, order.message, logging.WARNING if order.exchanged or order.open else logging.INFO)
        disparity = self.in_picture_pixels(estimate, exchanged=order is not None and order.exchanged)
        if views.right is not None:
            reason = pair_checks.identical_views(views, disparity) or pair_checks.few_matches(
                disparity, self.grid.known_mask
            )
            if reason:
                doubt(log, reason)
        return disparity

    @property
    def matched_views(self) -> Views:
        """The pictures on the working grid as they are matched: along rows, also where one camera stands below."""
        views = self.views
        if not self._is_vertical or views.right is None:
            return views
        return Views(_quarter_turns(views.left, 1), _quarter_turns(views.right, 1), views.calibration)

    def estimate(self, method: Callable[[Views], DisparityMap]) -> DisparityMap:
        """Return the method's map of the views. Raises: BrokenMethod for another size; whatever the method raises."""
        views = self.matched_views
        estimate = method(views)
        self.check_shape("disparity", estimate.disparity_px.shape, views.shape)
        if not self._is_vertical:
            return estimate
        return DisparityMap(
            _quarter_turns(estimate.disparity_px, -1), _quarter_turns(estimate.confidence, -1), estimate.unit
        )

    def order(self, estimate: DisparityMap, views: Views) -> ViewOrder | None:
        """Return the order of the views as the map shows it; None for one view, or where the file gives the order."""
        if self._order_is_given or self._is_vertical or views.right is None:
            return None
        original = self.context.scene.views
        offset_px = original.calibration.offset_px if original and original.calibration else None
        return pair_checks.view_order(estimate, views.left, offset_px and offset_px / self.grid.factor)

    def in_picture_pixels(self, estimate: DisparityMap, exchanged: bool) -> DisparityMap:
        """Return the map on the working grid in pixels of the pictures, unknown where the pictures are."""
        ordered = pair_checks.correct_exchanged(estimate) if exchanged else estimate
        return known_disparity(scaling.to_picture_pixels(ordered, self.context.scene.shape[1]), self.grid.known_mask)

    def full_size(self, value: DisparityMap) -> DisparityMap:
        return self.grid.full_disparity(value)

    @property
    def note(self) -> str:
        return self.grid.note

    @cached_property
    def refusal(self) -> TangibleError | None:
        scene, depth = self.context.scene, self.config.depth
        if scene.views is None:
            return no_picture(scene)
        if depth is None:
            return self.config.missing("depth")
        if depth.method.needs_pair and scene.views.right is None:
            give = (
                "say how they lie in it, such as `layout: side-by-side`"
                if scene.frames
                else "give both, `left:` and `right:`"
            )
            return PictureError(
                f"depth method {depth.name} needs two views, and the scene {scene.name} has one: {give}, "
                "or name a method for one picture (`tangible plugins` lists them)"
            )
        return None

    @property
    def _order_is_given(self) -> bool:
        files = self.context.scene.files
        return isinstance(files, SceneFiles) and files.order == "as-named"

    @property
    def _is_vertical(self) -> bool:
        views = self.context.scene.views
        return views is not None and views.calibration is not None and views.calibration.vertical


def _quarter_turns(values: np.ndarray, quarters: int) -> np.ndarray:
    return np.ascontiguousarray(np.rot90(values, quarters))
