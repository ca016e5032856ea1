"""The design of a study: the keys of its file, and its trials."""

from .study import Comparison as Comparison
from .study import Condition as Condition
from .study import Study as Study
