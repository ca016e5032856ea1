"""Legibility for fingers: the rules of tactile graphics, and parts that are simplified until they meet them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
