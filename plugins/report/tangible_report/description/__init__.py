"""A surface in words, for people who do not see it: facts about its parts, and sentences in a language."""

from .at_length import Told as Told
from .at_length import describe_at_length as describe_at_length
from .at_length import page_of as page_of
from .at_length import tell as tell
from .describing import PartFacts as PartFacts
from .describing import describe as describe
from .describing import facts as facts
