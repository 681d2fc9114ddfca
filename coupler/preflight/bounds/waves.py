"""The waves of water of particles: how long, how high, and how old when the goal judges them.

Started: the shortest of the bodies' fields, else, of a surface that slopes, half a wave along the water. Driven by
walls at the rate ω: k of g k tanh kH = ω², crests of a height tanh kH min(1, k L/2) of the way at least (a piston's are
2 (cosh 2kH − 1)/(sinh 2kH + 2 kH) of it, those of a long tank L shaken slowly ω² L/(2 g)), 1/|1 − (ω/ω1)²| times that
where they have come back from the far end, as its first mode ω1 answers, or ωt/2 as long as it grows; by a steady
speed U, U √(H/g).

Torn: particles that nothing shifts (wcsph) hold together by tension. With a support past 2.8 dx those at the waterline
clump on the wall and shoot out, and the water gains energy, up to six times its wave's: from waves 2 dx high on (3 to
4 dx in deeper water, whatever α up to 0.1), at any height with α below 0.02, and without viscosity even where tension
is cut (fluid.negative_pressure = none), which keeps all others whole. Not where the sides are periodic.
                                                                                   seiches of 1 m, dx 17 to 50 mm
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight.finding import STEADY
from coupler.preflight.measures.gravity import upward
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import goals_probe, goals_quantity
from shared.geometry.regions import corners_of
from shared.geometry.segments import right_of
from shared.geometry.shakers import shakers
from shared.schema.fluid import VelocityField
from shared.schema.scene import Scene

_LOOSE = 2.8  # support over dx
_HIGH = 1.5  # dx
_PULLED, _WORN = 0.02, 0.005  # least α that holds particles under tension, and without


@dataclass(frozen=True)
class Wave:
    """Wave number `k` [1/m], `omega` [rad/s], `height` [m] of its crests over level, `age` [s] when it is judged;
    `swings`: it passes through level at the start, and then as it will."""

    k: float
    omega: float
    height: float
    age: float
    swings: bool = False


def wave_of(scene: Scene, n: Numbers) -> Wave | None:
    """The wave that the water starts with or that walls make; None where it has no surface or no weight, or rests."""
    if not n.water.waves:
        return None
    g, deep = math.hypot(*scene.gravity), n.water.height
    across = right_of(upward(scene))
    along = corners_of(scene.fluid.bodies) @ across
    fields = [body.velocity_field for body in scene.fluid.bodies if body.velocity_field and body.velocity_field.speed]
    makers = [one for one in shakers(scene) if not one.structure]
    maker = None if fields else max(makers, key=lambda one: one.speed, default=None)
    if fields:
        k = 2.0 * math.pi / min(field.wavelength for field in fields)
    elif maker is not None and maker.rate > 0.0:
        k = _wave_number(maker.rate, g, deep)
    else:
        k = math.pi / float(np.ptp(along))
    omega = math.sqrt(g * k * math.tanh(k * deep))
    if maker is not None:
        age = _seen(scene, maker.points @ across, along, _group(k, omega, deep))
        height = maker.speed * math.sqrt(deep / g)
        if maker.rate > 0.0:
            length = float(np.ptp(along))
            height = maker.way * math.tanh(k * deep) * min(1.0, 0.5 * k * length)
            if age == scene.end_time:
                first = math.pi / length
                off = abs(1.0 - omega**2 / (g * first * math.tanh(first * deep)))
                height /= min(1.0, max(off, 2.0 / (omega * age)))
        return Wave(k, omega, height, age)
    height = max((abs(field.speed) for field in fields if field.kind == "standing-wave"), default=0.0) / omega
    return Wave(k, omega, max(height, 0.5 * n.water.slope), _age(scene, fields, 2.0 * math.pi / omega), bool(fields))


def torn(scene: Scene, n: Numbers) -> bool:
    """Whether tension clumps particles at the waterline of walls."""
    wave = wave_of(scene, n)
    loose = n.water.model == "wcsph" and n.water.support > _LOOSE * n.water.dx
    sides = scene.fluid.periodic.x is None and scene.fluid.periodic.y is None
    if wave is None or not loose or not sides:
        return False
    alpha = scene.fluid.alpha + 8.0 * scene.fluid.viscosity / (n.water.h * n.water.sound_speed)
    if scene.fluid.negative_pressure == "none":
        return alpha < _WORN
    return alpha < _PULLED or wave.height > _HIGH * n.water.dx


def _age(scene: Scene, fields: list[VelocityField], period: float) -> float:
    """Of a wave that swings from the start on, as the goal's statistic sees it: where a field lifts the surface, its
    crest comes after a quarter of a period and its trough after three, elsewhere the other way round; the most motion
    comes at once."""
    goal, end = scene.goal, scene.end_time
    if goal is None or goal.statistic in STEADY:
        return 0.5 * (scene.output.average_from + end)
    if goal.statistic not in ("max", "min"):
        return end
    if goals_quantity(scene) != "elevation":
        return 0.0 if goal.statistic == "max" else end
    lifted = sum(one.speed * math.cos(2.0 * math.pi * goals_probe(scene).point[0] / one.wavelength) for one in fields)
    return min((0.25 if lifted * {"max": 1.0, "min": -1.0}[goal.statistic] > 0.0 else 0.75) * period, end)


def _seen(scene: Scene, maker: np.ndarray, along: np.ndarray, group: float) -> float:
    """Of a wave from a `maker` at these places (m,) [m] over water `along` (n,) [m]: its way to the gauge, as long as
    none is back from the far end; else until the end."""
    if scene.goal is None or goals_quantity(scene) != "elevation":
        return scene.end_time
    gauge = np.asarray(goals_probe(scene).point) @ right_of(upward(scene))
    way = float(np.abs(maker - gauge).min())
    back = 2.0 * float(np.abs(along[:, None] - maker).min(axis=1).max()) - way
    return way / group if group * scene.end_time < back else scene.end_time


def _group(k: float, omega: float, deep: float) -> float:
    """Speed [m/s] at which waves arrive."""
    twice = min(2.0 * k * deep, 100.0)
    return 0.5 * omega / k * (1.0 + twice / math.sinh(twice))


def _wave_number(omega: float, g: float, deep: float) -> float:
    """k [1/m] of g k tanh kH = ω², by Newton's steps from a good guess (Eckart 1952)."""
    x = omega**2 * deep / g
    y = x / math.sqrt(math.tanh(x))
    for _ in range(6):
        t = math.tanh(y)
        y -= (y * t - x) / (t + y * (1.0 - t * t))
    return y / deep
