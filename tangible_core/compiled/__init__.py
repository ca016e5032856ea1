"""Compilation: how kernels are compiled, called by address, and run on threads."""
