"""The parts of a picture: connected regions of its segments, their heights, and the relief made of them."""

from .depth import depth_heights as depth_heights
from .find import find_parts as find_parts
from .find import part_sizes as part_sizes
from .find import reduced_parts as reduced_parts
from .guess import guess_heights as guess_heights
from .heights import HeightChoice as HeightChoice
from .heights import PartChoice as PartChoice
from .heights import PartHeights as PartHeights
from .heights import SimplifyChoice as SimplifyChoice
from .layering import Layering as Layering
