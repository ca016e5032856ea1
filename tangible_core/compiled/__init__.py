"""Kernels compiled by numba: compilation, loading, threads, and touches made of kernels."""
