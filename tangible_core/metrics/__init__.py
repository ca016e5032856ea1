"""How far results are from the truth: disparity maps, and segments."""

from .disparity import absolute_error as absolute_error
from .disparity import disparity_errors as disparity_errors
from .disparity import visible_pixels as visible_pixels
from .segments import segment_errors as segment_errors
