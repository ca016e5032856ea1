"""Every check of the conformance kit, over every method that is shipped."""

from tangible_core.plugins.registry import default_registry
from tangible_core.testing import conforms

for each in default_registry().listings:
    if each.distribution == "tangible-images":
        test = conforms(each.kind, each.name)
        globals()[f"test_{each.kind}_{each.name}".replace("-", "_")] = test
del test  # pytest would collect it once more
