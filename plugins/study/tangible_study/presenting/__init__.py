"""Presentation of trials: the surfaces of a study on a device, trial by trial, and whether they were rendered."""
