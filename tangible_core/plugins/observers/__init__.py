"""Observers that come with the house; plugins like any other."""
