"""Checks before a motor moves: of the surface, the force law, the device and this machine; a verdict a line."""

from .checks import CHECKS as CHECKS
from .checks import judge as judge
from .fitting import fit_surface as fit_surface
from .flight import Flight as Flight
from .flight import Hand as Hand
from .flight import Loop as Loop
from .flight import Settings as Settings
from .legibility import Legibility as Legibility
from .preflight import Preflight as Preflight
from .survey import survey as survey
from .timing import PERCENTILES as PERCENTILES
from .verdict import Change as Change
from .verdict import Verdict as Verdict
from .wording import relation as relation
