"""The library of materials, and the assignment of materials to segments."""
