"""Errors of disparity maps, segments and forces against the truth; the stable stiffness."""

from .disparity import absolute_error as absolute_error
from .disparity import benchmark_errors as benchmark_errors
from .disparity import disparity_errors as disparity_errors
from .disparity import visible_pixels as visible_pixels
from .forces import force_errors as force_errors
from .forces import force_steps as force_steps
from .forces import loop_works as loop_works
from .forces import proxy_lag as proxy_lag
from .segments import segment_errors as segment_errors
from .sparsification import sparsification_curve as sparsification_curve
from .sparsification import sparsification_errors as sparsification_errors
from .stability import HANDLE as HANDLE
from .stability import Handle as Handle
from .stability import stiffness_limit as stiffness_limit
