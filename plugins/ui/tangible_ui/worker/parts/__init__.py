"""The parts editor's computations: opening, heights, outlines, proposals, saving."""
