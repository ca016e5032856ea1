"""Studies with an observer model in place of a person: what an experiment would find before anybody is invited."""

from .observers import OBSERVERS as OBSERVERS
from .observers import make_observer as make_observer
from .power import plan as plan
from .power import simulate as simulate
