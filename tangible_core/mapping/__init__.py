"""The mapping from hand to picture, for any device: scale, offset, rotation, zoom, clutch and limits."""

from .device import MappedDevice, intended_path, map_device, over, placement_of
from .options import WorkspaceMapping
from .placement import Placement

__all__ = ["MappedDevice", "Placement", "WorkspaceMapping", "intended_path", "map_device", "over", "placement_of"]
