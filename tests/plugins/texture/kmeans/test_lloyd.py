"""Clusters of a known division, their number and their map of labels: else `report` and `kornia-gabor` are wrong."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.compiled import threads
from tangible_texture.energies.filter_choice import is_flat, is_one_texture
from tangible_texture.kmeans import lloyd as module
from tangible_texture.kmeans.lloyd import choose_count, kmeans, label_map_of_cells, margins, segment_by_kmeans
from tangible_texture.regions.refining import remove_seams


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


def test_clusters_of_one_seed_are_the_same_with_any_threads(monkeypatch):
    rows = np.random.default_rng(0).normal(size=(2000, 4)).astype(np.float32)
    monkeypatch.setattr(module, "BLOCK", 300)
    expected = kmeans(rows, 5, seed=7, start="random")
    monkeypatch.setattr(threads, "thread_count", lambda: 5)
    again = kmeans(rows, 5, seed=7, start="random")
    assert np.array_equal(expected.labels, again.labels)
    assert np.array_equal(expected.centres, again.centres)
    assert not np.array_equal(kmeans(rows, 5, seed=8, start="random").labels, expected.labels)


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


def test_rows_differing_by_rounding_are_one_cluster():
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
        number, confidence, reason = choose_count(rows, most, seed=2)
        assert number == best
        assert confidence == pytest.approx((every[best] - 0.25) / 0.75, abs=1e-4)
        assert reason.endswith(f"silhouette, {every[best]:.2f}")


def test_flat_picture_and_one_group_have_one_segment():
    rows = np.random.default_rng(0).normal(size=(4000, 12)).astype(np.float32)
    assert (choose_count(rows, 8)[0], choose_count(np.ones((30, 4), np.float32), 8)[:2]) == (1, (1, 1))
    assert choose_count(np.ones((1, 4), np.float32), 8)[0] == 1
    assert is_flat(np.full((9, 9), np.float32(0.1)))
    assert is_flat(np.float32(1e20) * (1 + 1e-7 * np.random.default_rng(0).random((9, 9))).astype(np.float32))
    assert is_flat((np.arange(81) == 40).astype(np.float32).reshape(9, 9))
    assert not is_flat(np.float32(1e-20) * (np.indices((9, 9))[0] > 4).astype(np.float32))
    grey = np.random.default_rng(0).random((64, 64)).astype(np.float32)
    even = np.ones((3, 16, 16), np.float32)
    assert is_one_texture(even, 1, grey)
    halves = even + (np.arange(16) > 7)
    assert not is_one_texture(halves, 1, grey)
    folded = np.pad(0.001 * halves[:, 4:-4, 4:-4], ((0, 0), (4, 4), (4, 4)), constant_values=1)
    assert is_one_texture(folded, 1, grey)
    framed = np.pad(0 * grey[16:-16, 16:-16], 16, constant_values=1) * grey
    assert not is_one_texture(folded, 1, framed)


def test_cells_and_centres_give_labels_with_confidence():
    found = label_map_of_cells(np.array([[1, 0]], np.int32), np.array([0.25, 1], np.float32), 3, (2, 5))
    assert found.labels.tolist() == [[0, 0, 0, 1, 1]] * 2
    assert found.confidence.tolist() == [[0.25] * 3 + [1] * 2] * 2
    centres = np.array([[0, 0], [4, 0], [100, 0]], np.float32)
    rows = np.array([[0, 0], [1, 0], [2, 0], [4, 0]], np.float32)
    assert margins(rows, centres) == pytest.approx([1, 2 / 3, 0, 1])
    assert margins(rows, centres[:1]).tolist() == [1] * 4
    features = np.zeros((4, 6, 2), np.float32)
    features[:, 4:] = 1
    found = segment_by_kmeans(features, 2, (7, 12), 5, seed=0)
    assert np.array_equal(found.labels, (np.arange(12) >= 8).astype(np.int32)[None].repeat(7, axis=0))
    assert (found.confidence == 1).all()


@pytest.mark.parametrize(("spread", "one"), [(0.02, True), (0.05, False), (0.16, False)])
def test_features_spread_by_under_three_percent_are_one_texture(spread: float, one: bool):
    grey = np.random.default_rng(0).random((64, 64)).astype(np.float32)
    checks = np.indices((16, 16)).sum(axis=0) % 2 * 2 - 1
    assert is_one_texture((1 + spread * checks)[None].astype(np.float32), 0.25, grey) == one


def test_a_narrow_strip_goes_to_its_neighbours():
    labels = np.repeat([0, 2, 1], [20, 4, 20]).astype(np.int32)[None].repeat(30, axis=0)
    found, same = remove_seams(labels, 3)
    assert np.array_equal(found, np.repeat([0, 1], 22).astype(np.int32)[None].repeat(30, axis=0))
    assert np.array_equal(same, labels != 2)
    assert np.array_equal(remove_seams(labels, 1)[0], labels)
