"""What is read off the updated-Lagrangian solid's state: tracers, energy, stress, and what has gone wrong.

`S`: the state, see updated_fields.py; `free` (n,): slots of the bodies' particles; `moduli`: G [Pa], c² = K/ρ0 [m²/s²],
ρ0 [kg/m³], E' [Pa].
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from solid_solver.energies import stress_energy
from solid_solver.stresses import stress_fields
from solid_solver.updated_fields import ACTS, E0, E1, G00, G11, IRHO, OWN, RHO, SXX, SZZ, M, U, V, X, Y
from solid_solver.updated_quadratic import PULL, Z_ROWS
from solid_solver.updated_steps import NEAREST2

FRACTURE_GAP = 2.0
"""Distance to the nearest particle, over the spacing, past which the body has come apart."""

TORN = 2.5
"""Distance of two particles that stood side by side, over that at the start, past which the body is torn between them:
further than most kernels reach. A row that parts from the next keeps its own neighbours, so that no gap shows."""

PAIRED_GAP = 0.1
"""The same, below which two particles have paired; the stable step goes with it, to nothing."""

DENSITY_RANGE = 3.0
"""Factor on the reference density, up and down, past which the state is absurd."""


def tracers(S: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity (n, 2) of the material tracers."""
    e, g = S[E0 : E1 + 1, free], S[G00 : G11 + 1, free]
    across = np.stack([g[0] * e[0] + g[1] * e[1], g[2] * e[0] + g[3] * e[1]])
    return np.ascontiguousarray((S[X : Y + 1, free] + e).T), np.ascontiguousarray((S[U : V + 1, free] + across).T)


def strain_energy(S: np.ndarray, extent: tuple[int, int], moduli: tuple, curvature: int) -> float:
    """Energy [J/m] of the stresses in `extent` (first slot, particles), at fixed particles too where they act."""
    shear, c_squared, density, bending = moduli
    body = S[:, extent[0] : extent[0] + extent[1]]
    pressure = c_squared * (body[RHO] - density)
    of_strain = shear, c_squared * density, bending
    energy = stress_energy(body[SXX : SZZ + 1], pressure, body[OWN : OWN + curvature], body[M] * body[IRHO], of_strain)
    if curvature == Z_ROWS:  # beside Z there is a pull's own
        energy += body[PULL] * body[M] * body[IRHO]
    return float(energy @ body[ACTS])


def stresses(S: np.ndarray, free: np.ndarray, moduli: tuple) -> dict[str, np.ndarray]:
    """Stress fields (n,) [Pa] of the particles."""
    pressure = moduli[1] * (S[RHO, free] - moduli[2])
    xx, xy, yy, zz = S[SXX : SZZ + 1, free]
    return stress_fields(xx - pressure, yy - pressure, zz - pressure, xy.copy())


def side_by_side(x: np.ndarray, free: np.ndarray, extents: list[tuple[int, int]], reach: float) -> tuple:
    """Pairs of a body's particles at `x` (2, slots) nearer than `reach` [m], one of them in `free` at least: numbers in
    `free` of the first (k,), slots (k, 2), squared distance (k,) [m²]."""
    number = np.full(x.shape[1], -1)
    number[free] = np.arange(len(free))
    pairs = [
        base + cKDTree(x[:, base : base + size].T).query_pairs(reach, output_type="ndarray") for base, size in extents
    ]
    slots = np.concatenate(pairs)
    slots = np.where((number[slots[:, 0]] < 0)[:, None], slots[:, ::-1], slots)
    slots = slots[number[slots[:, 0]] >= 0]
    return number[slots[:, 0]], slots, _squared(x, slots)


def _squared(x: np.ndarray, slots: np.ndarray) -> np.ndarray:
    return np.sum((x[:, slots[:, 0]] - x[:, slots[:, 1]]) ** 2, axis=0)


def failure(
    S: np.ndarray, free: np.ndarray, gauge: np.ndarray, reference: float, pairs: tuple
) -> tuple[str, int] | None:
    """What has gone wrong, and the number of a particle where; None if nothing. `reference`: ρ0 [kg/m³]; `pairs`: of
    `side_by_side` at the start."""
    density, gap = S[RHO, free], np.sqrt(gauge[NEAREST2, free])
    finite = np.isfinite(density + S[SXX : SZZ + 1, free].sum(axis=0))
    if not finite.all():
        return "the state is not finite", int(np.argmin(finite))
    if density.min() < reference / DENSITY_RANGE or density.max() > reference * DENSITY_RANGE:
        particle = int(density.argmin() if density.min() < reference / DENSITY_RANGE else density.argmax())
        return f"the density is {density[particle]:.3g} kg/m³", particle
    if gap.max() > FRACTURE_GAP:
        particle = int(np.argmax(gap))
        return f"the nearest particle is {gap[particle]:.2g} spacings away (fracture)", particle
    first, slots, squared = pairs
    apart = np.sqrt(_squared(S[X : Y + 1], slots) / squared)
    if apart.max(initial=0.0) > TORN:
        torn = int(np.argmax(apart))
        times = f"{apart[torn]:.2g} times as far apart as at the start"
        return f"particles side by side are {times} (fracture)", int(first[torn])
    if gap.min() < PAIRED_GAP:
        particle = int(np.argmin(gap))
        return f"the nearest particle is {gap[particle]:.2g} spacings away (pairing, which ends in fracture)", particle
    return None
