"""SIMD lanes inside numba."""
