"""Studies with an observer model in place of a person: what an experiment would find before anybody is invited."""

from .observers import OBSERVERS as OBSERVERS
from .observers import observer_of as observer_of
from .power import plan as plan
from .power import simulate as simulate
