"""What a tick of each law takes: by size of the surface, with and without what can be left out, law by law."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from time import thread_time

import numpy as np
from numba import njit

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import HapticSurface, Material
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer
from tangible_core.plugins.registry import default_registry
from tangible_render.effects.stub_law import stub_law as constant
from tangible_render.kernels import tangible_mask as tangible_mask_kernels
from tangible_render.lateral_shape import LateralShape
from tangible_render.penalty import Penalty
from tangible_render.proxy import Proxy
from tangible_render.surface.dequantise import grey_levels
from tangible_render.tangible_mask import TangibleMask, summed_tables
from tangible_render.with_materials import WithMaterials

from .figures import Figure, table
from .render_waves import HAND, TICKS, path, surface
from .turns import in_turns


def figures() -> Iterator[Figure]:
    """Yield the proxy by size, materials around a law against both apart, and the mask against the plain sum."""
    yield from _growth()
    yield from _around()
    yield from _mask()


def _growth() -> Iterator[Figure]:
    hands = path(HAND)
    touches = {f"{count}": Proxy().touch(surface(count)) for count in (64, 256, 1024, 4096)}
    times = in_turns({name: _twice(touch.path, hands) for name, touch in touches.items()}, 25, thread_time)
    ns = {name: 1e9 * each.seconds / TICKS / 2 for name, each in times.items()}
    told = ", ".join(f"{name}^2 {each:.0f}" for name, each in ns.items())
    yield Figure("`proxy` tick", "<= 400 ns", told, max(ns.values()) <= 400)
    ratio = max(each.ratio for each in times.values())
    yield Figure("the same, slowest over 64^2", "<= 1.3 x", f"{ratio:.2f} x", ratio <= 1.3)


def _around() -> Iterator[Figure]:
    hands, ratios = path(HAND), dict[str, float]()
    for law, renders in (("penalty", Penalty()), ("lateral-shape", LateralShape())):
        for name in ("ice", "sand", "rubber"):
            felt = covered(256, library()[name])
            own = renders.touch(felt).path
            both, alone = WithMaterials(law=law).touch(felt).path, _materials_alone(law, felt).path
            apart, together = (_all(own, alone, hands), _twice(both, hands))
            ratios[f"{law} on {name}"] = in_turns({"apart": apart, "both": together}, 15, thread_time)["both"].ratio
    worst = max(ratios, key=lambda pair: ratios[pair])
    told = f"{np.median(list(ratios.values())):.2f} x; the most {ratios[worst]:.2f} x ({worst})"
    yield Figure("`with-materials` against law and materials apart", "<= 1.3 x", told, ratios[worst] <= 1.3)


def _materials_alone(law: str, felt: HapticSurface) -> CompiledTouch:
    """`with-materials` around a kernel that always says 1 N, in place of the law; the call of it is in."""
    touch = WithMaterials(law=law).touch(felt)
    assert isinstance(touch, CompiledTouch)
    push = CompiledTouch(constant, (np.zeros(6), np.array([0.0, 0.0, 1.0])))
    return CompiledTouch(touch.tick, (push.fixed, push.address(), *touch.fixed[2:]))


def _all(first: Callable[..., object], second: Callable[..., object], hands: np.ndarray) -> Callable[[], object]:
    return lambda: (first(hands), second(hands), first(hands), second(hands))


def _twice(call: Callable[[np.ndarray], object], hands: np.ndarray) -> Callable[[], object]:
    return lambda: (call(hands), call(hands))


def _mask() -> Iterator[Figure]:
    side, hands = 65, path(0.3)
    map_ = surface(512)
    dark = 255 - grey_levels(map_.height_m)
    rows, columns = ((0.5 - hands[:, 1] / 0.08) * 512).astype(int), ((0.5 + hands[:, 0] / 0.08) * 512).astype(int)
    rows, columns = rows.clip(32, 479), columns.clip(32, 479)
    plain, quick = np.empty((2, TICKS, 2), np.int64)
    tables = summed_tables(dark)
    calls = {
        "tables": lambda: _by_tables(tables, rows, columns, side // 2, quick),
        "plain": lambda: _by_sums(dark, rows, columns, side // 2, plain),
        "tick": _twice(TangibleMask(mask_px=side).touch(map_).path, hands[: TICKS // 2]),
    }
    times = in_turns(calls, 15, thread_time)
    ratio = times["plain"].ratio
    told = f"{ratio:.0f} x; {times['plain'].seconds / times['tick'].seconds:.0f} x with all of the tick; "
    same = bool((plain == quick).all())
    yield Figure(
        "`tangible-mask` 65 x 65 against the plain sum", ">= 50 x, equal", told + f"equal: {same}", ratio >= 50 and same
    )


@njit(nogil=True)
def _by_sums(dark, rows, columns, half, out):  # noqa: ANN001, ANN202
    for i in range(rows.size):
        across, along = 0, 0
        for v in range(-half, half + 1):
            for u in range(-half, half + 1):
                value = np.int64(dark[rows[i] + v, columns[i] + u])
                across += value * u
                along -= value * v
        out[i, 0], out[i, 1] = across, along


@njit(nogil=True)
def _by_tables(tables, rows, columns, half, out):  # noqa: ANN001, ANN202
    for i in range(rows.size):
        out[i, 0], out[i, 1] = tangible_mask_kernels.window(tables, rows[i], columns[i], half, half)


def skips() -> list[str]:
    """Yield a row for each part left out: the time saved, and how far its forces differ along the same path."""
    level = HapticSurface.from_heights(np.full((256, 256), 0.004))
    flat = path(HAND)
    flat[:, 2] = 0.003
    over, high = path(HAND, -0.0005), path(HAND, -0.02)
    general = Proxy(damping_n_s_per_m=1e-300)  # too little to be felt, so that the law of all parts runs
    smooth, textured = (covered(256, replace(library()["sand"], roughness_m=each)) for each in (0.0, 1e-300))
    waves, fine = Proxy().touch(surface(256)), Proxy().touch(surface(1024))
    rows = [
        ("no texture, sand's friction", Proxy().touch(smooth), path(HAND), Proxy().touch(textured)),
        ("no friction, no damping, one material", waves, path(HAND), general.touch(surface(256))),
        ("a level tile", Proxy().touch(level), flat, general.touch(level)),
        ("the height over a hand under all of a tile, 1024^2", fine, path(HAND), _unsure(surface(1024))),
        ("free air, 0.5 mm over the surface", waves, over, None),
        ("free air, over all of a tile", waves, high, None),
    ]
    lines = []
    for what, less, hands, whole in rows:
        apart = np.abs(less.path(hands) - whole.path(hands)).max() if whole else 0.0
        all_of_it = _twice(whole.path, hands) if whole else _twice(less.path, path(HAND))
        times = in_turns({"whole": all_of_it, "less": _twice(less.path, hands)}, 15, thread_time)
        ns = [1e9 * times[name].seconds / TICKS / 2 for name in ("whole", "less")]
        lines.append((what, f"{ns[0]:.0f}", f"{ns[1]:.0f}", f"{times['less'].ratio:.2f}", f"{apart:.1g}"))
    return table(("left out", "all of it, ns", "without, ns", "share", "apart, N"), lines)


def _unsure(felt: HapticSurface) -> CompiledTouch:
    """Return the proxy, told of no tile how deep it goes."""
    touch = Proxy().touch(felt)
    assert isinstance(touch, CompiledTouch)
    tiles_m = touch.fixed[5].copy()
    tiles_m[..., 1] = -np.inf
    return CompiledTouch(touch.tick, (*touch.fixed[:5], tiles_m, *touch.fixed[6:]), touch.memory)


def covered(count: int, material: Material) -> HapticSurface:
    """Return the waves, all of one material."""
    waves = surface(count)
    return HapticSurface(waves.relief, np.zeros((count, count), np.int32), (material,))


def laws() -> list[str]:
    """Return a row for each law that is shipped."""
    felt, hands = surface(256), path(HAND)
    methods: dict[str, ForceRenderer] = {
        each.name: default_registry().load("render", each.name)()
        for each in default_registry().listings
        if each.kind == "render" and each.distribution == "tangible-images" and each.name != "with-materials"
    }
    touches = {name: each.touch(felt) for name, each in methods.items()}
    touches["proxy, friction 0.6 and 0.4"] = Proxy(static_friction=0.6, dynamic_friction=0.4).touch(felt)
    for name in ("ice", "sand", "rubber"):
        touches[f"proxy on {name}"] = Proxy().touch(covered(256, library()[name]))
        for law in ("penalty", "lateral-shape"):
            touches[f"with-materials around {law} on {name}"] = WithMaterials(law=law).touch(
                covered(256, library()[name])
            )
    times = in_turns({name: _twice(each.path, hands) for name, each in touches.items()}, 15, thread_time)
    return table(
        ("law", "ns a tick"), [(name, f"{1e9 * each.seconds / TICKS / 2:.0f}") for name, each in times.items()]
    )
