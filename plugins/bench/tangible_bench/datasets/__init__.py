"""Standard sets: the pairs of the stereo benchmarks, read as their archives unpack; nothing is downloaded."""

from .choosing import SetScene as SetScene
from .choosing import pairs as pairs
from .folders import match_files as match_files
from .sets import SETS as SETS
from .sets import StandardSet as StandardSet
from .standard_pair import FULL_PX as FULL_PX
from .standard_pair import MarkedPair as MarkedPair
from .standard_pair import StandardPair as StandardPair
