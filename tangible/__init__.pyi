from tangible_core import *
from tangible_depth import *
from tangible_devices import *
from tangible_export import *
from tangible_render import *
from tangible_texture import *

__version__: str
