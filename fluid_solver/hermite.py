"""Hermite's cubic: the motion between two times at which place and speed are known."""

from __future__ import annotations


def hermite(s, length, x0, v0, x1, v1):
    """Value x and rate v at the fraction `s` of an interval of `length` [s], from those at its start and its end."""
    a = 2.0 * (x0 - x1) + length * (v0 + v1)
    b = 3.0 * (x1 - x0) - length * (2.0 * v0 + v1)
    return x0 + s * (length * v0 + s * (b + s * a)), v0 + s * (2.0 * b + 3.0 * s * a) / length
