"""Readers of the formats that a scene may be in: pictures, maps, pairs, phone photos, height maps, calibrations."""
