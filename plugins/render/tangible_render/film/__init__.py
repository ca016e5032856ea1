"""Surfaces that move under the proxy: three slots of surfaces, and the ticks that interpolate between them."""
