"""Errors of disparity maps and of forces against the truth."""

from .disparity import absolute_error as absolute_error
from .disparity import benchmark_errors as benchmark_errors
from .disparity import disparity_errors as disparity_errors
from .disparity import visible_pixels as visible_pixels
from .forces import force_errors as force_errors
from .forces import force_steps as force_steps
from .forces import loop_works as loop_works
from .forces import proxy_lag as proxy_lag
