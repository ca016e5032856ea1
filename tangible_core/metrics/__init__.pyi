from .measured import load_measured as load_measured
from .truth_errors import absolute_error as absolute_error
from .truth_errors import disparity_errors as disparity_errors
from .truth_errors import force_errors as force_errors
