from .device import MappedDevice as MappedDevice
from .device import intended_path as intended_path
from .device import map_device as map_device
from .device import over as over
from .device import placement_of as placement_of
from .placement import Placement as Placement
from .placement import WorkspaceMapping as WorkspaceMapping
