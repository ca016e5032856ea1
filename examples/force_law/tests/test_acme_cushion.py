import numpy as np
from acme_cushion.compiled import CompiledCushion
from acme_cushion.cushion import Cushion

from tangible_core.testing import conforms
from tangible_core.testing.synthetic import sphere_cap

test_plain = conforms("render", "acme-cushion")
test_compiled = conforms("render", "acme-cushion-compiled")


def test_both_feel_the_same():
    surface = sphere_cap().surface
    path_m = np.random.default_rng(1).uniform(-0.05, 0.05, (1000, 3))
    plain, compiled = (law().touch(surface).path(path_m) for law in (Cushion, CompiledCushion))
    assert plain.any()
    assert np.allclose(plain, compiled, rtol=1e-5, atol=1e-6)
