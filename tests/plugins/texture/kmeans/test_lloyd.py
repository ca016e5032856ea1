"""Clusters of a known division, and the estimate of their number."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.compiled import threads
from tangible_texture.kmeans import lloyd as module
from tangible_texture.kmeans.count import choose_count
from tangible_texture.kmeans.lloyd import kmeans


def blobs(count, each=200, dims=5, seed=0, apart=20.0):
    """Return points around distant centres, and the centre of each point."""
    rng = np.random.default_rng(seed)
    centres = apart * np.eye(count, dims) + apart * (np.arange(count) // dims)[:, None]
    truth = rng.permutation(np.repeat(np.arange(count), each))
    return (centres[truth] + rng.normal(size=(truth.size, dims))).astype(np.float32), truth


def same_parts(one, other):
    return len({*zip(one.tolist(), other.tolist(), strict=True)}) == len({*one.tolist()}) == len({*other.tolist()})


@pytest.mark.parametrize("start", ["plus-plus", "random"])
@pytest.mark.parametrize("count", [1, 2, 5])
def test_clusters_of_distant_points_are_exact(start, count):
    rows, truth = blobs(count)
    found = kmeans(rows, count, restarts=30, seed=1, start=start)
    assert same_parts(found.labels, truth)
    for k in range(count):
        assert found.centres[k] == pytest.approx(rows[found.labels == k].mean(axis=0), abs=1e-4)
    assert found.cost == pytest.approx(np.square(rows - found.centres[found.labels]).sum(), rel=1e-4)


def test_rows_have_the_nearest_centre_and_centres_are_means():
    rows = np.random.default_rng(0).normal(size=(3000, 7)).astype(np.float32)
    found = kmeans(rows, 6, seed=3)
    away = np.square(rows[:, None] - found.centres).sum(axis=2)
    assert np.array_equal(away.argmin(axis=1), found.labels)
    means = [rows[found.labels == k].mean(axis=0) for k in range(6)]
    assert found.centres == pytest.approx(np.array(means), abs=1e-5)


def test_clusters_of_one_seed_are_the_same_with_any_threads(monkeypatch):
    rows = np.random.default_rng(0).normal(size=(2000, 4)).astype(np.float32)
    monkeypatch.setattr(module, "BLOCK", 300)
    expected = kmeans(rows, 5, seed=7, start="random")
    monkeypatch.setattr(threads, "thread_count", lambda: 5)
    again = kmeans(rows, 5, seed=7, start="random")
    assert np.array_equal(expected.labels, again.labels)
    assert np.array_equal(expected.centres, again.centres)
    assert not np.array_equal(kmeans(rows, 5, seed=8, start="random").labels, expected.labels)


def test_cost_with_more_restarts_is_not_higher():
    rows = np.random.default_rng(0).normal(size=(500, 3)).astype(np.float32)
    costs = [kmeans(rows, 8, restarts, seed=0).cost for restarts in (1, 3, 10)]
    assert costs == sorted(costs, reverse=True)
    assert costs[2] < costs[0]


@given(
    st.integers(1, 6), st.integers(1, 12), st.sampled_from(["plus-plus", "random"]), st.sampled_from([1e-15, 1, 1e15])
)
def test_clusters_are_not_more_than_distinct_rows(distinct, clusters, start, scale):
    rows = np.float32(scale) * (np.arange(40) % distinct).astype(np.float32)[:, None].repeat(2, axis=1)
    found = kmeans(rows, clusters, seed=clusters, start=start)
    assert len(found.centres) <= min(distinct, clusters)
    assert np.array_equal(np.unique(found.labels), np.arange(len(found.centres)))
    if clusters >= distinct:
        assert len(found.centres) == distinct
        assert found.cost == 0


@pytest.mark.parametrize("empty", [0, 1, 2])
def test_cluster_without_any_row_is_dropped(empty: int):
    rows = np.array([[4], [4], [5], [5], [6], [20]], np.float32)
    starts = np.insert(np.array([[3.5], [19.0]], np.float32), empty, 500, axis=0)
    found = module._settle(rows, starts, 100)
    assert found.labels.tolist() == [0, 0, 0, 0, 0, 1]
    assert found.centres == pytest.approx(np.array([[4.8], [20.0]]))
    assert found.cost == pytest.approx(2.8)


def test_cluster_losing_all_its_rows_is_dropped():
    """The second cluster starts with the first two rows, and its neighbours take them."""
    rows = np.array([[0, 4], [9, 8], [8, 4], [1, 0], [4, 2], [9, 5], [2, 0]], np.float32)
    starts = np.array([[6, 0], [6, 5], [7, 3]], np.float32)
    assert np.square(rows[:, None] - starts).sum(axis=2).argmin(axis=1).tolist() == [1, 1, 2, 0, 0, 2, 0]
    found = module._settle(rows, starts, 100)
    assert found.labels.tolist() == [0, 1, 1, 0, 0, 1, 0]
    assert found.centres == pytest.approx(np.array([[1.75, 1.5], [26 / 3, 17 / 3]]))
    assert found.cost == pytest.approx(np.square(rows - found.centres[found.labels]).sum())


def test_rows_differing_by_rounding_are_one_cluster():
    """The threshold is a hundred thousandth of the longest row; a ten thousandth is above it."""
    away = np.random.default_rng(0).random((100, 3))
    assert len(kmeans((7 + 3e-5 * away).astype(np.float32), 5).centres) == 1
    assert len(kmeans((7 + 7e-4 * away).astype(np.float32), 5).centres) == 5


@pytest.mark.parametrize("weighted", [True, False])
def test_starts_are_drawn_by_squared_distance_or_uniformly(weighted: bool):
    random = np.random.default_rng(5)
    for _ in range(200):
        rows = random.integers(-50, 50, (30, 2)).astype(np.float32)
        uniform = random.random(3)
        chosen = [int(uniform[0] * 30)]
        for u in uniform[1:]:
            away = np.square(rows[:, None].astype(np.float64) - rows[chosen]).sum(axis=2).min(axis=1)
            weights = np.cumsum(away if weighted else away > 0)
            chosen.append(int(np.searchsorted(weights, u * weights[-1], side="right")))
        np.testing.assert_array_equal(module._start(rows, uniform, weighted, np.float32(0)), rows[chosen])


@pytest.mark.parametrize("count", [2, 3, 5])
def test_count_of_distant_groups_is_exact(count):
    guess = choose_count(blobs(count)[0], 8, seed=0)
    assert guess.segments == count
    assert 0.5 < guess.confidence < 1
    assert str(count) in guess.reason


def silhouette(rows: np.ndarray, labels: np.ndarray) -> float:
    """Return the mean silhouette by its definition; 0 for a row alone in its cluster."""
    found = []
    for row, label in zip(rows.astype(float), labels, strict=True):
        away = np.linalg.norm(rows - row, axis=1)
        own = np.count_nonzero(labels == label)
        others = [away[labels == each].mean() for each in np.unique(labels) if each != label]
        a, b = away[labels == label].sum() / max(own - 1, 1), min(others)
        found.append((b - a) / max(a, b) if own > 1 else 0)
    return float(np.mean(found))


def test_confidence_of_a_count_is_where_its_silhouette_lies_between_a_quarter_and_one():
    for rows, most in (
        (blobs(3, each=30, apart=9.0)[0], 5),
        (np.vstack([blobs(2, each=5)[0], np.full((1, 5), 90)]), 3),
    ):
        rows = rows.astype(np.float32)
        every = {count: silhouette(rows, kmeans(rows, count, 3, seed=2).labels) for count in range(2, most + 1)}
        shuffled = rows[np.random.default_rng(2).permutation(len(rows))]
        every = {count: silhouette(shuffled, kmeans(shuffled, count, 3, seed=2).labels) for count in every}
        best = max(every, key=every.__getitem__)
        found = choose_count(rows, most, seed=2)
        assert found.segments == best
        assert found.confidence == pytest.approx((every[best] - 0.25) / 0.75, abs=1e-4)
        assert found.reason.endswith(f"silhouette, {every[best]:.2f}")


def test_row_between_two_centres_goes_to_the_first():
    rows = np.array([[0, 0], [2, 0], [4, 0], [2, 5]], np.float32)
    assert module._settle(rows, np.array([[0, 0], [4, 0]], np.float32), 1).labels.tolist() == [0, 0, 1, 0]


def test_least_of_several_numbers_that_are_as_good_is_chosen(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_texture.kmeans.count._silhouette", lambda rows, labels: 0.5)
    assert choose_count(blobs(3, each=20)[0], 6).segments == 2


def test_count_of_one_group_is_one():
    rows = np.random.default_rng(0).normal(size=(4000, 12)).astype(np.float32)
    assert choose_count(rows, 8).segments == 1
    flat = choose_count(np.ones((30, 4), np.float32), 8)
    assert (flat.segments, flat.confidence) == (1, 1)
    assert choose_count(np.ones((1, 4), np.float32), 8).segments == 1


def test_count_with_a_bound_stays_within_it():
    assert choose_count(blobs(5)[0], 3).segments <= 3
    assert choose_count(blobs(5)[0], 1).segments == 1
    for most in (2, 3, 4):
        assert choose_count(blobs(5, each=20)[0], most).segments <= most


def test_count_of_one_seed_is_the_same():
    rows, _ = blobs(4, each=900, apart=4.0)
    assert choose_count(rows, 8, seed=5) == choose_count(rows, 8, seed=5)
