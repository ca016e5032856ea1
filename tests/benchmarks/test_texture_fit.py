"""The fit of the network of `gabor`: the layers are those that it applies, and the descent descends."""

import numpy as np
import pytest
import torch
from torch import nn

from benchmarks import texture_fit
from benchmarks.texture_fit import Example, Network, example, fit, loss, orders, variant
from tangible_core.testing.synthetic.textures import FAMILIES
from tangible_texture.features.features import features
from tangible_texture.learned import network as applied
from tangible_texture.learned.network import Weights, learned_values


@pytest.fixture(scope="module")
def examples() -> list[Example]:
    random = np.random.default_rng(1)
    greys = [family((300, 320), random) for family in FAMILIES.values()]
    scaled = [np.rint(255 * (each - each.min()) / np.ptp(each)).astype(np.uint8) for each in greys]
    variants = [[variant(each, random)] for each in scaled]
    return [made for seed in range(12) if (made := example(variants, seed))]


def test_layers_are_those_that_are_applied(monkeypatch: pytest.MonkeyPatch):
    torch.manual_seed(3)
    network = Network()
    for bias in (network.first_bias, network.second_bias):
        nn.init.normal_(bias)  # it begins at 0
    weights = {name: each.detach().numpy() for name, each in network.weights().items()}
    monkeypatch.setattr(applied, "_weights", lambda: Weights(**weights))
    picture = np.random.default_rng(2).integers(0, 256, (256, 320)).astype(np.uint8)
    picture[:, 150:] = picture[:, 150:] // 8 * 8
    windows = features(picture, 24.0, 0.0, colour=False)
    assert windows is not None
    narrow = windows.narrow.planes.reshape(-1, 32, 2, 40, 2).mean(axis=(2, 4))
    with torch.no_grad():
        expected = network(torch.tensor(narrow)).numpy().T
    found = learned_values(windows)
    assert found is not None
    expected = expected - expected.mean(axis=1, keepdims=True)
    np.testing.assert_allclose(found.planes, expected, atol=2e-3 * np.abs(expected).max())


def test_weights_shipped_are_tied_as_those_fitted():
    first = applied._weights().first
    free = first[: len(first) // 4]
    for index, order in enumerate(orders()):
        np.testing.assert_array_equal(first[index * len(free) : (index + 1) * len(free)], free[:, order])


def test_turn_and_flip_undo_themselves():
    same, turned, flipped, both = orders()
    for each in (turned, flipped, both):
        assert not np.array_equal(each, same)
        np.testing.assert_array_equal(each[each], same)


def test_fit_lowers_the_loss(capsys: pytest.CaptureFixture[str], examples: list[Example]):
    torch.manual_seed(0)
    before = np.mean([loss(Network(), each).item() for each in examples])
    after = np.mean([loss(network, each).item() for network in [fit(examples, examples[:2], 30)] for each in examples])
    assert after < 0.7 * before
    assert "30 of 30: " in capsys.readouterr().out


def test_variant_has_no_grey_and_its_own_place():
    family = FAMILIES["weave"]((300, 300), np.random.default_rng(4))
    grey = np.rint(255 * (family - family.min()) / np.ptp(family)).astype(np.uint8)
    made = [variant(grey, np.random.default_rng(seed)) for seed in (1, 1, 2)]
    assert made[0].shape == (texture_fit.SIDE_PX,) * 2
    assert made[0].mean() == pytest.approx(128, abs=1)
    np.testing.assert_array_equal(made[0], made[1])
    assert not np.array_equal(made[0], made[2])
