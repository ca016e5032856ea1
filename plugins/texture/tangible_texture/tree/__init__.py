"""The tree of a picture's regions: cells, cues of borders, small regions, and their joining pair by pair."""
