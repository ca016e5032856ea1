"""A kiosk: scenes in rotation on one device, for as long as an exhibition."""

from .kiosk import run_kiosk as run_kiosk
from .rotation import Slot as Slot
