"""Texts for people in their language: a catalogue a language, applied where a text is shown, never where it is made."""

from .translate import LANGUAGES as LANGUAGES
from .translate import language as language
from .translate import language_of_environment as language_of_environment
from .translate import localise as localise
from .translate import localise_marked as localise_marked
from .translate import set_language as set_language
from .translate import translate as translate
