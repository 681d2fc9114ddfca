"""Exchanges as plain vectors, for the accelerations and for measuring convergence.

A vector holds all fields of one or two exchanges, one after the other. The field that carries the coupling (the loads'
force, or pressure where the structure integrates that; the motion's mean velocity, and the velocity at the end) has
weight one over its own size, so that unlike fields count alike; the others have weight 0 and are carried along by the
same factors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shared.contract import Exchange, Loads, exchange_fields
from shared.schema.coupling import Coupling

_STILL = 1e-12
"""Mean speed [m/s] below which a motion counts as none."""


def pack(*exchanges: Exchange) -> np.ndarray:
    """All fields as one vector."""
    return np.concatenate([array.ravel() for one in exchanges for array in exchange_fields(one).values()])


def unpack(vector: np.ndarray, *like: Exchange) -> list[Exchange]:
    """Exchanges shaped like the given ones."""
    result, at = [], 0
    for one in like:
        fields = {}
        for name, array in exchange_fields(one).items():
            fields[name] = vector[at : at + array.size].reshape(array.shape)
            at += array.size
        result.append(type(one)(**fields))
    return result


@dataclass(frozen=True)
class Measure:
    """Sizes of residuals. `field`: of the loads, "force" or "pressure"."""

    relative: float
    absolute: float
    field: str

    @classmethod
    def of(cls, coupling: Coupling) -> Measure:
        """The scene's."""
        return cls(coupling.tolerance, coupling.tolerance_absolute, coupling.loads)

    def _leading(self, exchange: Exchange) -> str:
        return self.field if isinstance(exchange, Loads) else "velocity_mean"

    def leading(self, exchange: Exchange) -> np.ndarray:
        """The field that carries the coupling."""
        return getattr(exchange, self._leading(exchange))

    def _floor(self, exchange: Exchange) -> float:
        return self.absolute if isinstance(exchange, Loads) else _STILL

    def agrees(self, used: tuple[Exchange, ...], found: tuple[Exchange, ...]) -> bool:
        """Whether all differences are finite and below the relative or the absolute tolerance."""
        for before, after in zip(used, found, strict=True):
            name = self._leading(after)
            difference = _norm(getattr(after, name) - getattr(before, name))
            if not difference < np.inf or difference > max(
                self.relative * _norm(getattr(after, name)), self._floor(after)
            ):
                return False
        return True

    def change(self, used: Exchange, found: Exchange) -> float:
        """Size of the difference over that of what was found."""
        name = self._leading(found)
        difference = _norm(getattr(found, name) - getattr(used, name))
        return difference / max(_norm(getattr(found, name)), float(np.finfo(float).tiny))

    def weights(self, *found: Exchange) -> np.ndarray:
        """Weight of every entry of the packed vector."""
        parts = []
        for one in found:
            size = _norm(getattr(one, self._leading(one)))
            counted = (self._leading(one), *(() if isinstance(one, Loads) else ("velocity",)))
            for name, array in exchange_fields(one).items():
                parts.append(np.full(array.size, 1.0 / (size or 1.0) if name in counted else 0.0))
        return np.concatenate(parts)


def _norm(array: np.ndarray) -> float:
    """Root of the sum of squares; infinite for huge values."""
    with np.errstate(over="ignore"):
        return float(np.linalg.norm(array))
