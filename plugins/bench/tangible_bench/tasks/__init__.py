"""Kinds of methods that can be compared: their scenes, the call to time, and the measures of its result."""
