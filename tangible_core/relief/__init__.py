"""The relief of a depth map: heights where borders are, slopes that a hand can climb, and noise taken out."""

from .choice import ReliefChoice as ReliefChoice
from .edges import edge_relief as edge_relief
from .figure import figure_relief as figure_relief
from .lines import line_relief as line_relief
from .shaping import ReliefScale as ReliefScale
from .shaping import relief_scale as relief_scale
from .shaping import shape_relief as shape_relief
from .slope_limit import limit_slopes as limit_slopes
