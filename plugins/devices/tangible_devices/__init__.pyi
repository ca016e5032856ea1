from .falcon.falcon import Falcon as Falcon
from .falcon.falcon_simulated import FalconSimulated as FalconSimulated
from .force_dimension.force_dimension import ForceDimension as ForceDimension
from .haply.haply import Haply as Haply
from .mock import Mock as Mock
from .pointer.pointer import Pointer as Pointer
from .replay import Replay as Replay
