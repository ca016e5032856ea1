"""The steps of the Gabor segmenter against plain formulas: else textures are joined or divided wrongly."""

from math import exp, log

import numpy as np
import pytest

from tangible_core.compiled.small_matrices import eigen, solve
from tangible_core.plugins.notes import collected
from tangible_texture.clusters import planes as matrices
from tangible_texture.clusters.classes import Weights, largest_number, likeliest_division, number_likelihoods
from tangible_texture.clusters.discriminants import discriminant_axes, evidence, one_hot, scatters
from tangible_texture.clusters.full_size import pixel_labels
from tangible_texture.clusters.joining import Step, axes_between, join_clusters, measure_pairs
from tangible_texture.clusters.neighbourhood import INSIDE_CELLS, interior_shares, mean_field, smooth_memberships
from tangible_texture.clusters.planes import combine_planes, inner_products, scatter_matrix, scatter_matrix_in_kernel
from tangible_texture.features.patterns import COUNTERS, RADII, pattern_frequencies
from tangible_texture.signal.smoothing import gaussian


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(11)


@pytest.mark.parametrize("size", [1, 2, 7, 40])
def test_eigenvalues_and_solutions_match_lapack(random: np.random.Generator, size: int):
    root = random.standard_normal((size, size + 3))
    matrix = root @ root.T
    values, vectors = eigen(matrix)
    np.testing.assert_allclose(values, np.linalg.eigvalsh(matrix)[::-1], rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(vectors @ matrix @ vectors.T, np.diag(values), atol=1e-8)
    rows = random.standard_normal((3, size))
    np.testing.assert_allclose(solve(matrix, rows), np.linalg.solve(matrix, rows.T).T, rtol=1e-6, atol=1e-8)
    assert eigen(np.diag([5.0, 0, 3, 0, 0]))[0].tolist() == [5, 3, 0, 0, 0]


def test_products_of_planes_match_matrix_products(random: np.random.Generator):
    planes, others = (random.standard_normal((count, 2500)).astype(np.float32) for count in (7, 3))
    weights = random.random(2500).astype(np.float32)
    mix = random.standard_normal((4, 7))
    np.testing.assert_allclose(combine_planes(mix, planes), mix @ planes, atol=1e-4)
    np.testing.assert_allclose(inner_products(others, planes), others.astype(float) @ planes.T, atol=1e-2)
    np.testing.assert_allclose(scatter_matrix(planes, weights), (planes * weights) @ planes.T.astype(float), atol=1e-2)


@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_scatter_with_any_number_of_threads_has_the_same_bits(
    threads: int, random: np.random.Generator, monkeypatch: pytest.MonkeyPatch
):
    planes, weights = random.standard_normal((7, 9000)).astype(np.float32), random.random(9000).astype(np.float32)
    alone = scatter_matrix_in_kernel(planes, weights)
    monkeypatch.setattr(matrices, "SHARED", 1)
    monkeypatch.setattr(matrices, "thread_count", lambda: threads)
    assert np.array_equal(matrices.scatter_matrix(planes, weights), alone)
    assert np.array_equal(alone, alone.T)


def two_groups(random: np.random.Generator, count: int = 400) -> tuple[np.ndarray, np.ndarray]:
    labels = (np.arange(count) >= count // 2).astype(np.int32)
    planes = random.standard_normal((5, count)).astype(np.float32)
    planes[2] += 6 * labels
    return planes - planes.mean(axis=1, keepdims=True), labels


def test_discriminants_of_two_groups_find_the_separating_feature(random: np.random.Generator):
    planes, labels = two_groups(random)
    fit = scatters(planes, one_hot(labels, 2))
    axes = discriminant_axes(fit, 20)
    assert (axes.shape, np.abs(axes[0]).argmax()) == ((1, 5), 2)
    np.testing.assert_allclose(axes @ fit.within @ axes.T, [[1]], rtol=1e-6)
    assert np.mean(evidence(planes, fit).argmax(axis=0) == labels) > 0.99


@pytest.mark.parametrize(("count", "share"), [(50, 1.0), (400, 0.5), (8000, 0.05)])
def test_scatter_of_few_cells_is_shrunk_further(random: np.random.Generator, count: int, share: float):
    """The shrinkage is 200 cells' share, at least a twentieth and at most all."""
    planes, labels = two_groups(random, count)
    total = np.cov(planes, bias=True)
    centres = np.stack([planes[:, labels == k].mean(axis=1) for k in (0, 1)])
    within = total - centres.T @ centres / 2
    expected = within + share * total + share * np.trace(within) / 5 * np.eye(5)
    np.testing.assert_allclose(scatters(planes, one_hot(labels, 2)).within, expected, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("renewed", [0, 3])
def test_halves_of_one_group_cost_the_least_to_join(random: np.random.Generator, renewed: int):
    planes, labels = two_groups(random)
    shape = (20, 20)
    thirds = labels * 2 + (np.arange(400) // 20 % 10 >= 5) * (labels == 0)
    thirds = thirds.astype(np.int32)
    costs = measure_pairs(planes, thirds, interior_shares(thirds, shape)).joining_costs(0.4)
    assert np.unravel_index(costs.argmin(), costs.shape) == (1, 0)
    steps = list(join_clusters([planes], thirds, shape, renewed))
    assert [step.clusters for step in steps] == [3, 2, 1]
    np.testing.assert_array_equal(steps[1].labels, labels)
    assert steps[-1].cost == np.inf
    sizes = np.bincount(thirds)
    assert steps[0].size == sizes[0] * sizes[1] / (sizes[0] + sizes[1]) / 400
    assert steps[0].distance == pytest.approx(steps[0].cost / (3 * steps[0].size) ** 0.4)


def quarters(random: np.random.Generator) -> tuple[list[np.ndarray], np.ndarray, tuple[int, int]]:
    """Two sets of features of a grid in four quarters: the first tells the left from the right, the second all four."""
    shape = (20, 24)
    row, column = np.indices(shape)
    labels = (2 * (row >= 10) + (column >= 12)).astype(np.int32).ravel()
    noise = random.standard_normal((2, 3, labels.size)).astype(np.float32)
    places = np.array([[0, 8, 0.1, 8.1], [0, 3, 5, 9]], np.float32)
    return [each + place[labels] for each, place in zip(noise, places, strict=True)], labels, shape


@pytest.mark.parametrize("renewed", [0, 9])
def test_joining_costs_the_geometric_mean_of_its_costs_in_two_sets(random: np.random.Generator, renewed: int):
    sets, labels, shape = quarters(random)
    alone = [list(join_clusters([each], labels, shape, renewed)) for each in sets]
    assert [each.clusters for steps in alone for each in steps] == [4, 3, 2, 1] * 2
    for one, twice in zip(alone[0], join_clusters([sets[0], sets[0]], labels, shape, renewed), strict=True):
        np.testing.assert_array_equal(one.labels, twice.labels)
        assert one.clusters == 1 or twice.cost == pytest.approx(one.cost, rel=1e-3)
    both = list(join_clusters(sets, labels, shape, 0))
    for step, tolerance in zip(both, (1e-3, 0.1), strict=False):
        costs = [
            measure_pairs(each, step.labels, interior_shares(step.labels, shape)).joining_costs(0.4)
            for each in (
                combine_planes(axes_between(each, labels, interior_shares(labels, shape)), each) for each in sets
            )
        ]
        assert step.cost == pytest.approx(np.sqrt(costs[0] * costs[1]).min(), rel=tolerance)


def four_clusters(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, tuple[int, int]]:
    """Features of five planes, labels of four overlapping clusters, one of them in one piece, and the grid's shape."""
    shape = (12, 30)
    labels = random.integers(0, 3, shape).astype(np.int32)
    labels[:, 20:] = 3
    planes = random.standard_normal((5, labels.size)).astype(np.float32) + labels.ravel() * 0.3
    return planes.astype(np.float32), labels.ravel(), shape


def moments_by_formula(
    planes: np.ndarray, labels: np.ndarray, shape: tuple[int, int]
) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """Sizes, means and scatters of clusters, each cell weighed by the squared share of its own around it."""
    count = int(labels.max()) + 1
    own = one_hot(labels, count)
    weights = (own * (smooth_memberships(own, shape, INSIDE_CELLS) ** 2 + 1e-3)).max(axis=0).astype(np.float64)
    parts = [(planes[:, labels == k].astype(np.float64), weights[labels == k]) for k in range(count)]
    means = [np.average(part, axis=1, weights=heavy) for part, heavy in parts]
    return np.bincount(labels), means, [np.cov(part, aweights=heavy, ddof=0) for part, heavy in parts]


@pytest.mark.parametrize("power", [0.4, 0.8])
def test_joining_costs_match_their_formula(random: np.random.Generator, power: float):
    """The formula is D (m k / n)^power, D the squared Mahalanobis distance, in scatters with a ridge of a twentieth."""
    planes, labels, shape = four_clusters(random)
    sizes, means, scatter_of = moments_by_formula(planes, labels, shape)
    ridge = 0.05 * sum(size * np.trace(each) for size, each in zip(sizes, scatter_of, strict=True)) / sizes.sum() / 5
    costs = measure_pairs(planes, labels, interior_shares(labels, shape)).joining_costs(power)
    assert np.isinf(costs[np.triu_indices(4)]).all()
    for one in range(4):
        for other in range(one):
            step = means[one] - means[other]
            within = (scatter_of[one] + scatter_of[other]) / 2 + ridge * np.eye(5)
            size = sizes[one] * sizes[other] / (sizes[one] + sizes[other]) * 4 / sizes.sum()
            expected = step @ np.linalg.solve(within, step) * size**power
            assert costs[one, other] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("lower", "higher"), [(0, 1), (0, 3), (1, 3), (2, 3)])
def test_pairs_left_by_a_joining_have_the_moments_and_distances_of_the_joined_cells(
    random: np.random.Generator, lower: int, higher: int
):
    planes, labels, shape = four_clusters(random)
    pairs = measure_pairs(planes, labels, interior_shares(labels, shape))
    before = pairs.distances.copy()
    joined = np.where(labels == higher, lower, labels - (labels > higher)).astype(np.int32)
    found = pairs.join(lower, higher, planes, joined, shape)
    sizes, means, scatter_of = moments_by_formula(planes, joined, shape)
    np.testing.assert_array_equal(found.sizes, sizes)
    np.testing.assert_allclose(found.means, means, rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(found.scatters, scatter_of, rtol=1e-4, atol=1e-4)
    assert found.ridge == pairs.ridge
    for one, other in [(0, 1), (0, 2), (1, 2), (2, 1)]:
        step = means[one] - means[other]
        within = (scatter_of[one] + scatter_of[other]) / 2 + pairs.ridge * np.eye(5)
        assert found.distances[one, other] == pytest.approx(step @ np.linalg.solve(within, step), rel=1e-3)
    np.testing.assert_array_equal(pairs.distances, before)


def plain_patterns(grey: np.ndarray, radius: int) -> np.ndarray:
    """Count classes and agreements pixel by pixel; neighbours in turn from the right, upwards."""
    near = round(radius * np.sqrt(0.5))
    places = [(0, radius), (-near, near), (-radius, 0), (-near, -near)]
    places += [(-down, -right) for down, right in places]
    h, w = grey.shape
    framed = np.pad(grey, radius, mode="edge")
    found = np.zeros((COUNTERS, -(-h // 4), -(-w // 4)))
    for y, x in np.ndindex(h, w):
        bright = [bool(framed[y + radius + v, x + radius + u] >= grey[y, x] - 1e-3) for v, u in places]
        changes = sum(bright[i] != bright[i - 1] for i in range(8))
        here = found[:, y // 4, x // 4]
        here[sum(bright) if changes <= 2 else 9] += 1
        for i in range(4):
            here[10 + i] += not (bright[i] or bright[i + 4])
            here[14 + i] += bright[i] and bright[i + 4]
            here[18 + i] += ((bright[i] == bright[i + 2]) + (bright[i + 4] == bright[(i + 6) % 8])) / 2
    pixels = [np.bincount(np.arange(side) // 4) for side in (h, w)]
    return found / (pixels[0][:, None] * pixels[1])


@pytest.mark.parametrize("step", [5e-4, 0.4])
def test_frequencies_are_those_of_patterns_counted_one_by_one(random: np.random.Generator, step: float):
    grey = (step * random.integers(0, 4, (14, 11))).astype(np.float32)
    found = pattern_frequencies(grey).reshape(len(RADII), COUNTERS, 4, 3)
    np.testing.assert_allclose(found[0], plain_patterns(grey, 1), atol=1e-6)
    np.testing.assert_allclose(found[1], plain_patterns(grey, 3), atol=1e-6)


def test_neighbours_and_evidence_are_those_of_the_formulas(random: np.random.Generator):
    grey = random.standard_normal((24, 20)).astype(np.float32)
    found = pattern_frequencies(grey).reshape(len(RADII), COUNTERS, 6, 5)[2]
    smooth = gaussian(np.pad(grey, 12, mode="reflect")[..., None], 1.5)[12:-12, 12:-12, 0]
    np.testing.assert_allclose(found, plain_patterns(smooth, 5), atol=1e-6)
    planes, labels = two_groups(random)
    planes = planes + np.float32(3)
    fit = scatters(planes, one_hot(labels, 2))
    found = evidence(planes, fit)
    away = [planes.T - mean for mean in fit.means]
    logs = [-0.5 * np.einsum("nd,nd->n", each, np.linalg.solve(fit.within, each.T).T) for each in away]
    np.testing.assert_allclose(found[0] - found[1], logs[0] - logs[1], rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("shape", [(7, 12), (40, 41)])
def test_neighbours_are_averaged_by_a_gaussian_of_four_deviations(shape: tuple[int, int], random: np.random.Generator):
    from scipy.ndimage import gaussian_filter

    memberships = random.random((2, shape[0] * shape[1])).astype(np.float32)
    found = smooth_memberships(memberships, shape, 1.5)
    for one, other in zip(found, memberships, strict=True):
        expected = gaussian_filter(other.reshape(shape), 1.5, mode="reflect", truncate=4)
        np.testing.assert_allclose(one.reshape(shape), expected, atol=1e-5)


@pytest.mark.parametrize("offset", [0.0, -500.0, 500.0])
def test_memberships_are_those_of_evidence_and_four_times_the_neighbours(offset: float, random: np.random.Generator):
    """More cells than are processed at once; evidence far from 0 in all classes alike changes nothing."""
    shape = (40, 60)
    towards = random.normal(0, 2, (3, 2400)).astype(np.float32)
    own = one_hot(random.integers(0, 3, 2400), 3)
    expected = own
    for _ in range(2):
        logs = towards + 4 * smooth_memberships(expected, shape, 1.5)
        expected = np.exp(logs - logs.max(axis=0))
        expected = (expected / expected.sum(axis=0)).astype(np.float32)
    found = mean_field(towards + np.float32(offset), own, shape, 1.5, 2)
    np.testing.assert_allclose(found, expected, atol=1e-3)


@pytest.mark.parametrize("turned", [False, True])
def test_border_of_pixels_lies_between_the_centres_of_cells(turned: bool):
    memberships = np.array([[[0.9, 0.1]], [[0.1, 0.9]]], np.float32)
    if turned:
        labels, confidence = (
            pixel_label.T for pixel_label in pixel_labels(memberships.transpose(0, 2, 1).copy(), 4, (8, 2))
        )
    else:
        labels, confidence = pixel_labels(memberships, 4, (2, 8))
    np.testing.assert_array_equal(labels, [[0, 0, 0, 0, 1, 1, 1, 1]] * 2)
    np.testing.assert_allclose(confidence[0], confidence[0, ::-1], rtol=1e-5)
    assert confidence[0, 0] == pytest.approx(1 - 1 / 9)


LAST = (np.inf, 0.0)


def steps(*pairs: tuple[float, float], cells: int = 16384) -> list[Step]:
    """Return divisions down to one cluster, from the distance and size of each next joining."""
    counts = range(len(pairs) + 1, 0, -1)
    labels = np.arange(cells, dtype=np.int32)
    return [Step(labels % count, count, 1.0, *each) for count, each in zip(counts, (*pairs, LAST), strict=True)]


def test_probability_of_a_number_is_that_of_all_joinings_before_and_not_of_the_next():
    """Log-odds here: 0.5 + log D + 2 log size + 3 log cells."""
    weights = Weights(constant=0.5, distance=1, size=2, cells=3)
    odds = [0.5 + log(distance) + 2 * log(size) + 3 * log(4) for distance, size in ((1, 0.25), (2, 0.125), (3, 0.125))]
    two = [1 / (1 + exp(-odd)) for odd in odds]
    expected = [two[0], (1 - two[0]) * two[1], (1 - two[0]) * (1 - two[1]) * two[2]]
    found = [
        exp(number_likelihood)
        for number_likelihood in number_likelihoods(steps((1, 0.25), (2, 0.125), (3, 0.125), cells=4), weights)
    ]
    assert found == pytest.approx([*expected, 1 - sum(expected)])


@pytest.mark.parametrize(
    ("pairs", "segments", "other"),
    [
        ([(20, 0.02), (25, 0.02), (200, 0.1), (200, 0.2)], 3, 4),
        ([(20, 0.02), (25, 0.02), (14, 0.1), (500, 0.2)], 2, 3),
        ([(20, 0.02), (25, 0.02), (8, 0.1), (8, 0.2)], 1, 2),
        ([(500, 0.1), (500, 0.1)], 3, 2),
    ],
)
def test_joining_ends_before_two_textures_become_one(pairs: list[tuple[float, float]], segments: int, other: int):
    with collected() as notes:
        assert likeliest_division(steps(*pairs)).max() + 1 == segments
    [note] = notes
    assert note.startswith(f"segments: {segments}, estimated with confidence ")
    assert f"the next best number is {other}, with " in note


@pytest.mark.parametrize(("cells", "most"), [(1, 2), (287, 2), (288, 3), (1536, 16), (10**6, 16)])
def test_small_picture_has_few_textures(cells: int, most: int):
    assert largest_number(cells) == most


def test_confidence_is_the_probability_among_the_possible_numbers():
    rest = steps((25, 0.1), (60, 0.2))
    probabilities = np.exp(number_likelihoods(rest))
    assert probabilities.sum() == pytest.approx(1)
    with collected() as notes:
        likeliest_division(rest[:2])  # which never ends at one cluster
    assert f"confidence {probabilities[:2].max() / probabilities[:2].sum():.2f}" in notes[0]
    with collected() as notes:
        assert not likeliest_division(steps((0, 0.1), (0, 0.25))).any()
    assert notes == ["segments: 1, estimated with confidence 1.00: the next best number is 3, with 0.00"]
    with collected() as notes:
        likeliest_division(steps())
    assert notes == ["segments: 1, estimated with confidence 1.00: no two parts differ"]
