"""The mapping from hand to picture, for any device: scale, offset, rotation, zoom, clutch and limits."""

from .device import MappedDevice, map_device, placement_of
from .options import WorkspaceMapping
from .placement import Placement
from .scripted import intended_path, over

__all__ = ["MappedDevice", "Placement", "WorkspaceMapping", "intended_path", "map_device", "over", "placement_of"]
