"""Procedures: which trial is next, given the answers so far; others bring their own by an entry point."""

from ..design import Stimulus as Stimulus
from ..design import Trial as Trial
from ..questions.question import Score as Score
from .procedure import Course as Course
from .procedure import Procedure as Procedure
from .procedure import load_procedure as load_procedure
from .procedure import procedure_names as procedure_names
from .procedure import score as score
