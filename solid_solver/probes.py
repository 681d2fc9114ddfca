"""The solid's probes: displacement and stress at material points; energies, momenta, reactions and speeds of bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shared.schema import Scene
from shared.schema_probes import STRESSES, Probe
from shared.sides import is_solids
from solid_solver.bodies import LatticeBody

_REACH = 2.6  # spacings: particles about a point that its stress is fitted to


@dataclass(frozen=True)
class Observed:
    """What a model shows its probes. What takes work is a function, called only for a probe that asks.

    `displacement`, `velocity` (n, 2): of the material; `place`, `speed` (n, 2): position and velocity of the
    particles, which shifting may part from their material; `strain_energy(k)` [J/m], `clamp_force(k)` (2,) [N/m]: of
    body number k; `stress()`: named fields (n,) [Pa]; `gap(k)`: largest distance to the nearest particle over the
    spacing; `work`, `start` (bodies,) [J/m]: by all loads so far, and kinetic plus strain energy at t = 0.
    """

    displacement: np.ndarray
    velocity: np.ndarray
    place: np.ndarray
    speed: np.ndarray
    strain_energy: Callable[[int], float]
    clamp_force: Callable[[int], np.ndarray]
    stress: Callable[[], dict[str, np.ndarray]]
    gap: Callable[[int], float]
    work: np.ndarray
    start: np.ndarray


Value = Callable[[Observed], float]


def field_weights(position: np.ndarray, spacing: np.ndarray, axes: np.ndarray, point: np.ndarray):
    """Particles (k,) near a reference `point` (2,) [m], and weights (k,) that carry a field known at particles there.

    From a least-squares fit of a quadratic, or as much of one as the particles determine.
    """
    s = (position - point) @ axes.T / spacing
    distance = np.sqrt(np.sum(s * s, axis=1))
    reach = max(_REACH, float(distance.min()) + _REACH - 0.5)
    near = np.flatnonzero(distance < reach)
    a, b = s[near].T
    basis = np.stack([np.ones_like(a), a, b, 0.5 * a * a, a * b, 0.5 * b * b], axis=1)
    weight = 1.0 - distance[near] / reach
    return near, np.linalg.pinv(weight[:, None] * basis)[0] * weight


def _displacement(probe: Probe, body: LatticeBody, moving: bool) -> Value:
    """`moving`: a clamp of the body moves, so that the fit with points held still does not hold."""
    if moving:
        column, weight = field_weights(body.position, body.spacing, body.axes, np.array(probe.point))
        column = body.first + column
    else:
        _, column, weight = body.point_weights(np.array([probe.point], dtype=float))
    component = 0 if probe.quantity == "displacement-x" else 1
    return lambda seen: float(weight @ seen.displacement[column, component])


def _stress(probe: Probe, body: LatticeBody) -> Value:
    near, weight = field_weights(body.position, body.spacing, body.axes, np.array(probe.point))
    column = body.first + near
    if probe.quantity != "von-mises":
        name = probe.quantity.replace("-", "_")
        return lambda seen: float(weight @ seen.stress()[name][column])

    def von_mises(seen: Observed) -> float:
        fields = seen.stress()
        xx, yy, xy, p = (weight @ fields[n][column] for n in ("stress_xx", "stress_yy", "stress_xy", "pressure"))
        zz = -3.0 * p - xx - yy
        return float(np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2))

    return von_mises


def kinetic_energy(mass: np.ndarray, velocity: np.ndarray) -> float:
    """½ Σ m v² [J/m] of particles of `mass` (n,) [kg/m]."""
    return float(0.5 * mass @ np.sum(velocity**2, axis=1))


def _of_body(quantity: str, k: int, own: slice, mass: np.ndarray) -> Value:
    """A quantity of body number `k`, whose particles are `own`, of `mass` (n,) [kg/m]."""

    def kinetic(seen: Observed) -> float:
        return kinetic_energy(mass, seen.speed[own])

    def angular(seen: Observed) -> float:
        x, v = seen.place[own], seen.speed[own]
        return float(mass @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]))

    return {
        "kinetic-energy": kinetic,
        "strain-energy": lambda seen: seen.strain_energy(k),
        "external-work": lambda seen: float(seen.work[k]),
        "dissipated": lambda seen: float(seen.start[k] + seen.work[k] - kinetic(seen) - seen.strain_energy(k)),
        "momentum-x": lambda seen: float(mass @ seen.speed[own, 0]),
        "momentum-y": lambda seen: float(mass @ seen.speed[own, 1]),
        "angular-momentum": angular,
        "reaction-x": lambda seen: float(seen.clamp_force(k)[0]),
        "reaction-y": lambda seen: float(seen.clamp_force(k)[1]),
        "spacing-max": lambda seen: seen.gap(k),
        "max-speed": lambda seen: float(np.sqrt(np.max(np.sum(seen.velocity[own] ** 2, axis=1)))),
    }[quantity]


def solid_probes(scene: Scene, bodies: list[LatticeBody]) -> dict[str, Value]:
    """The probes that belong to the solid, by name, as functions of what the model shows."""
    number = {b.shape.name: k for k, b in enumerate(bodies)}
    moving = {clamp.body for clamp in scene.solid.clamps if clamp.motion is not None}
    result: dict[str, Value] = {}
    for probe in scene.probes:
        if not is_solids(scene, probe):
            continue
        k = number[probe.body]
        body = bodies[k]
        if probe.quantity in ("displacement-x", "displacement-y"):
            result[probe.name] = _displacement(probe, body, probe.body in moving)
        elif probe.quantity in STRESSES:
            result[probe.name] = _stress(probe, body)
        else:
            mass = np.full(len(body.position), scene.solid.density * body.cell)
            result[probe.name] = _of_body(probe.quantity, k, body.own, mass)
    return result


def wants_work(scene: Scene) -> bool:
    """Whether a probe needs the work of the loads kept."""
    return any(probe.quantity in ("external-work", "dissipated") for probe in scene.probes)
