from .flat import Flat as Flat
from .gabor import Gabor as Gabor
from .gradient import Gradient as Gradient
from .hierarchy import Hierarchy as Hierarchy
from .histogram import Histogram as Histogram
from .kornia_gabor import KorniaGabor as KorniaGabor
from .kornia_gradient import KorniaGradient as KorniaGradient
from .report import Report as Report
