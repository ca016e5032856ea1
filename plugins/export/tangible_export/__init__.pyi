from .glb import Glb as Glb
from .heights import Heights as Heights
from .pins import Pins as Pins
from .stl import Stl as Stl
from .swell import Swell as Swell
from .three_mf import ThreeMF as ThreeMF
