from tangible_core.testing import conforms

test_blocks = conforms("depth", "acme-blocks")
