"""Derivatives on a particle lattice by a quadratic moving-least-squares fit, made once in the reference state.

Symbols: ξ = (i, j) position in units of the lattice's own spacings, s_b = ξ_b − ξ_a, w kernel weight. About each
particle a the field f(ξ) = f_a + g·s + ½ s·H·s is fitted to its neighbours by least squares,

    M c = Σ_b w_b p(s_b) (f_b − f_a),   p(s) = (s_0, s_1, s_0²/2, s_0 s_1, s_1²/2),   M = Σ_b w_b p pᵀ,

so that each derivative is a fixed sum over neighbours, exact for quadratic fields. Neighbours are lattice points and
points held on clamped faces. The latter add to M and to the particle's own coefficient, and need no storage: they stand
still, or move as combinations of a few given fields, each of which has its coefficients of the derivatives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from shared.jit import njit
from shared.kernels import Kernel, kernel_w

DERIVATIVES = 5
"""∂0, ∂1, ∂00, ∂01, ∂11, along the lattice's own axes."""

WORST_CONDITION = 1.0e7
"""Condition number of M past which a neighbourhood is refitted over a wider support. Regular ones, edges and clamps
included, lie below 1e3; collinear points give infinity."""

WIDENING = (1.0, 1.3, 1.7, 2.2)
"""Factors on the support tried in turn where a neighbourhood cannot carry a quadratic (sharp corners)."""


@dataclass(frozen=True)
class Fit:
    """`offset` (k, 2): lattice offsets of the neighbours, itself included; `coefficient` (n, k, 5) [in index units],
    zero where there is no particle; `held` (n, g, 5): derivatives by the fields that held points move in, each of size
    1; `deficient` (n,): neighbourhoods that carry no quadratic at any support."""

    offset: np.ndarray
    coefficient: np.ndarray
    held: np.ndarray
    deficient: np.ndarray


@njit
def _weights(code, r2, h):
    w = np.empty(r2.size)
    for i in range(r2.size):
        w[i] = kernel_w(code, r2[i], h)
    return w


def lattice_weights(kernel: Kernel, h: float, offset: np.ndarray) -> np.ndarray:
    """Kernel weight of each offset (..., 2) in index units for smoothing length `h` in index units."""
    r2 = np.sum(offset * offset, axis=-1)
    return _weights(kernel.code, np.ascontiguousarray(r2.ravel()), h).reshape(r2.shape)


def basis(s: np.ndarray) -> np.ndarray:
    """p(s) for offsets (..., 2) → (..., 5)."""
    a, b = s[..., 0], s[..., 1]
    return np.stack([a, b, 0.5 * a * a, a * b, 0.5 * b * b], axis=-1)


def basis_slope(s: np.ndarray, towards: np.ndarray) -> np.ndarray:
    """Derivative (5,) of p at offset `s` (2,) in the direction `towards` (2,) [index units]."""
    (a, b), (p, q) = s, towards
    return np.array([p, q, a * p, a * q + b * p, b * q])


def _offsets(reach: float) -> np.ndarray:
    """Lattice offsets nearer than `reach`, row by row, first axis fastest."""
    m = math.ceil(reach)
    j, i = np.meshgrid(np.arange(-m, m + 1), np.arange(-m, m + 1), indexing="ij")
    s = np.stack([i.ravel(), j.ravel()], axis=1)
    return s[np.sum(s * s, axis=1) < reach * reach]


def _present(index: np.ndarray, subset: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Whether the lattice has a particle at `index[subset]` + `offset`: (m, k)."""
    low = index.min(axis=0)
    reach = np.abs(offset).max()
    grid = np.zeros(index.max(axis=0) - low + 1 + 2 * reach, dtype=bool)
    grid[tuple((index - low + reach).T)] = True
    at = (index[subset] - low + reach)[:, None, :] + offset[None, :, :]
    return grid[at[..., 0], at[..., 1]]


def _fixed_sums(kernel, h, reach, points, fixed, fixed_weight, fields):
    """Contributions of fixed points to M (m, 5, 5), to Σ w p (m, 5), and Σ w p f of their `fields` (m, g, 5)."""
    moment = np.zeros((len(points), DERIVATIVES, DERIVATIVES))
    total = np.zeros((len(points), DERIVATIVES))
    driven = np.zeros((len(points), fields.shape[1], DERIVATIVES))
    if len(fixed) == 0:
        return moment, total, driven
    near = cKDTree(points).query_ball_tree(cKDTree(fixed), reach)
    a = np.repeat(np.arange(len(points)), [len(b) for b in near])
    b = np.array([k for row in near for k in sorted(row)], dtype=np.int64)
    s = fixed[b] - points[a]
    wp = (fixed_weight * lattice_weights(kernel, h, s))[:, None] * basis(s)
    np.add.at(moment, a, wp[:, :, None] * basis(s)[:, None, :])
    np.add.at(total, a, wp)
    np.add.at(driven, a, fields[b][:, :, None] * wp[:, None, :])
    return moment, total, driven


def _solve(kernel, h, index, subset, fixed, fixed_weight, fields):
    """Fit of the particles `subset` at smoothing length `h`: offsets, coefficients (m, k, 5), those of `fields`
    (m, g, 5), condition (m,)."""
    reach = kernel.support * h
    offset = _offsets(reach)
    p = basis(offset.astype(float))
    w = lattice_weights(kernel, h, offset.astype(float)) * _present(index, subset, offset)
    wp = w[:, :, None] * p
    moment, total, driven = _fixed_sums(kernel, h, reach, index[subset].astype(float), fixed, fixed_weight, fields)
    moment += np.einsum("akc,kd->acd", wp, p)
    total += wp.sum(axis=1)
    condition = np.linalg.cond(moment)
    regular = condition < WORST_CONDITION
    inverse = np.zeros_like(moment)
    inverse[regular] = np.linalg.inv(moment[regular])
    coefficient = np.einsum("acd,akd->akc", inverse, wp)
    itself = int(np.flatnonzero(np.all(offset == 0, axis=1))[0])
    coefficient[:, itself] = -np.einsum("acd,ad->ac", inverse, total)
    return offset, coefficient, np.einsum("acd,agd->agc", inverse, driven), condition


def quadratic_fit(
    kernel: Kernel, h: float, index: np.ndarray, fixed: np.ndarray, fixed_weight: float, fields: np.ndarray
) -> Fit:
    """Fit on the lattice points `index` (n, 2, whole numbers) with points `fixed` (m, 2, same units) that stay put, or
    move in the `fields` (m, g).

    `h` is the smoothing length in index units. Where a neighbourhood is too poor, its support is widened.
    """
    count = len(index)
    widest = _offsets(kernel.support * h * WIDENING[-1])
    coefficient = np.zeros((count, len(widest), DERIVATIVES))
    held = np.zeros((count, fields.shape[1], DERIVATIVES))
    place = {tuple(s): k for k, s in enumerate(widest)}
    subset = np.arange(count)
    for factor in WIDENING:
        offset, found, driven, condition = _solve(kernel, h * factor, index, subset, fixed, fixed_weight, fields)
        regular = condition < WORST_CONDITION
        columns = np.array([place[tuple(s)] for s in offset])
        coefficient[subset[regular][:, None], columns[None, :]] = found[regular]
        held[subset[regular]] = driven[regular]
        subset = subset[~regular]
        if len(subset) == 0:
            break
    used = np.any(coefficient != 0.0, axis=(0, 2)) | np.all(widest == 0, axis=1)
    used |= used[::-1]  # the list reversed is the list negated: each neighbour relation needs its reverse
    deficient = np.zeros(count, dtype=bool)
    deficient[subset] = True
    return Fit(widest[used], coefficient[:, used], held, deficient)
