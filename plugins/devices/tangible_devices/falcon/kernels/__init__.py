"""Compiled kernels of a Falcon: packets, kinematics, velocity, and a tick of the force loop."""
