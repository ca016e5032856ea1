import cv2
import numpy as np
from matplotlib import pyplot
from tangible import DisparityMap, Pipeline, Scene, Views, show
from tangible_core.plugins import DepthEstimator


class Blocks(DepthEstimator):
    """Sum of absolute differences over a square window; the best shift wins."""

    window_px: int = 9

    def estimate(self, views: Views) -> DisparityMap:
        left, right = (cv2.cvtColor(view, cv2.COLOR_RGB2GRAY) for view in (views.left, views.right))
        shifts = (np.abs(left - np.roll(right, shift, axis=1)) for shift in range(64))
        costs = [cv2.blur(cost, (self.window_px, self.window_px)) for cost in shifts]
        return DisparityMap(np.argmin(costs, axis=0).astype(np.float32))


pipeline = Pipeline(Scene.builtin("motorcycle"), depth=Blocks(window_px=11))
show(pipeline.disparity, pyplot.gca())
pyplot.savefig("disparity.png")
# look at: disparity.png
