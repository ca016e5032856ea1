"""Where the picture lies under the hand: scale, offset, turn, zoom, clutch and limits, for every device alike."""

from .device import MappedDevice, mapped, placement_of
from .options import WorkspaceMapping
from .placement import Placement
from .scripted import over, wanted

__all__ = ["MappedDevice", "Placement", "WorkspaceMapping", "mapped", "over", "placement_of", "wanted"]
