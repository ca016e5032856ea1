from .disparity import absolute_error as absolute_error
from .disparity import disparity_errors as disparity_errors
from .forces import force_errors as force_errors
from .measured import load_measured as load_measured
