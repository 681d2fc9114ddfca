"""Smoothing kernels in two dimensions as compiled functions of the squared distance.

Symbols: r = |r_ab|, h smoothing length, q = r/h, W [1/m²], F = (1/r) dW/dr [1/m⁴] and ∇_a W_ab = F r_ab.

    wendland-c2, support 2 h, σ = 7/(4π h²)
        W = σ (1 − q/2)⁴ (1 + 2q)        F = −5 σ/h² (1 − q/2)³
    quintic-spline, support 3 h, σ = 7/(478π h²)
        W = σ [(3 − q)⁵ − 6 (2 − q)⁵ + 15 (1 − q)⁵]      F = −5 σ/(q h²) [(3 − q)⁴ − 6 (2 − q)⁴ + 15 (1 − q)⁴]

each bracket cut off at zero. Wendland 1995 (in SPH: Dehnen & Aly 2012), Schoenberg 1946 (Morris 1997).

`code` chooses the kernel; make it a constant of the calling loop (a closure over an int, or a literal), then
the compiler removes the other one. No branches, so that loops over pairs vectorise; F is finite at r = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from shared.contract import BadInput
from shared.jit import inline_njit, njit

WENDLAND_C2 = 0
QUINTIC_SPLINE = 1

_SIGMA_WENDLAND = 7.0 / (4.0 * math.pi)
_SIGMA_QUINTIC = 7.0 / (478.0 * math.pi)


@dataclass(frozen=True)
class Kernel:
    """A kernel by `name`; its `code` for the compiled functions; its `support` radius in h."""

    name: str
    code: int
    support: float


_KERNELS = {
    "wendland-c2": Kernel("wendland-c2", WENDLAND_C2, 2.0),
    "quintic-spline": Kernel("quintic-spline", QUINTIC_SPLINE, 3.0),
}


def kernel_named(name: str) -> Kernel:
    """The kernel called `name`; BadInput when there is none."""
    if name not in _KERNELS:
        raise BadInput(f"There is no kernel {name!r}; choose one of {', '.join(_KERNELS)}.")
    return _KERNELS[name]


def w_scale(code, h):
    """W over its shape [1/m²]: a factor that a sum over neighbours need not carry."""
    return (_SIGMA_WENDLAND if code == WENDLAND_C2 else _SIGMA_QUINTIC) / (h * h)


def f_scale(code, h):
    """F over its shape [1/m⁴]."""
    return -5.0 * (_SIGMA_WENDLAND if code == WENDLAND_C2 else _SIGMA_QUINTIC) / (h * h * h * h)


_w_scale, _f_scale = inline_njit(w_scale), inline_njit(f_scale)


@inline_njit
def w_shape(code, r2, h):
    """The brackets of W at squared distance `r2` [m²]."""
    q = math.sqrt(r2) * (1.0 / h)
    if code == WENDLAND_C2:
        t = max(0.0, 1.0 - 0.5 * q)
        t2 = t * t
        return t2 * t2 * (1.0 + 2.0 * q)
    a = max(0.0, 3.0 - q)
    b = max(0.0, 2.0 - q)
    c = max(0.0, 1.0 - q)
    a2 = a * a
    b2 = b * b
    c2 = c * c
    return a2 * a2 * a - 6.0 * b2 * b2 * b + 15.0 * c2 * c2 * c


@inline_njit
def f_shape(code, r2, h):
    """The brackets of F at squared distance `r2` [m²], of the quintic spline over q."""
    q = math.sqrt(r2) * (1.0 / h)
    if code == WENDLAND_C2:
        t = max(0.0, 1.0 - 0.5 * q)
        return t * t * t
    # Inside q < 1 the bracket is q (24 − 24 q² + 10 q³) exactly, so that nothing is divided by a small q.
    a = max(0.0, 3.0 - q)
    b = max(0.0, 2.0 - q)
    a2 = a * a
    b2 = b * b
    outer = (a2 * a2 - 6.0 * b2 * b2) / max(q, 1.0)
    inner = 24.0 + q * q * (10.0 * q - 24.0)
    return inner if q < 1.0 else outer


@inline_njit
def kernel_w(code, r2, h):
    """W [1/m²] at squared distance `r2` [m²]."""
    return _w_scale(code, h) * w_shape(code, r2, h)


@inline_njit
def kernel_f(code, r2, h):
    """F = (1/r) dW/dr [1/m⁴] at squared distance `r2` [m²]."""
    return _f_scale(code, h) * f_shape(code, r2, h)


@njit
def _evaluate(code, r, h, w, f):
    for i in range(r.size):
        w[i] = kernel_w(code, r[i] * r[i], h)
        f[i] = kernel_f(code, r[i] * r[i], h)


def evaluate(kernel: Kernel, r: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """W [1/m²] and F = (1/r) dW/dr [1/m⁴] at distances `r` (any shape) [m]."""
    r = np.ascontiguousarray(r, dtype=np.float64)
    w = np.empty_like(r)
    f = np.empty_like(r)
    _evaluate(kernel.code, r.ravel(), float(h), w.ravel(), f.ravel())
    return w, f
