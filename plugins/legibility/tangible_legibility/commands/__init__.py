"""The command that the rules add to `tangible`."""
