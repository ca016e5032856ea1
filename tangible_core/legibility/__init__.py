"""Whether fingers can read it: the rules of tactile graphics, and parts that are simplified until they keep them."""

from .choice import SimplifyChoice as SimplifyChoice
