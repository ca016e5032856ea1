"""Requests about the surface on the screen: a fine texture at a place, a description in words."""

from typing import Literal

from .table import forward

forward("texture_patch", digest=str, x_m=float, y_m=float, side_m=float, pixels=(int, 192))
forward("description", language=Literal["en", "de", "fr"])
