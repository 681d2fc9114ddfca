"""What several tests share: a small toy model of each side, with exact answers."""

from __future__ import annotations

import importlib
import sys

import numpy as np
import pytest

import shared.commands
from shared.contract import Description, Frame, Kinematics, Loads


class ToySpring:
    """Four points that move in y together: m Y'' = F − k Y, by exact integration under a constant mean force."""

    role = "structure"

    def __init__(self, mass=2.0, stiffness=50.0):
        self.mass, self.omega = mass, np.sqrt(stiffness / mass)
        self.reference = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        self.y, self.v, self.done = 0.0, 0.0, 0

    def describe(self):
        numbers = {"density": self.mass, "thickness": 1.0, "wave_speed": 1.0}
        volume, body = np.full(4, 0.25), np.zeros(4, dtype=np.int64)
        return Description("solid", "structure", "toy", 1.0, 1.0, self.reference, volume, body, numbers)

    def begin(self, motion):
        return Kinematics.at_rest(self.reference)

    def stable_step(self):
        return 1.0

    def advance(self, t0, t1, substeps, boundary):
        force = float(boundary.force[:, 1].sum()) if boundary is not None else 0.0
        rest, dt, w = force / (self.mass * self.omega**2), t1 - t0, self.omega
        y, v = self.y - rest, self.v
        y1 = rest + y * np.cos(w * dt) + v / w * np.sin(w * dt)
        v1 = v * np.cos(w * dt) - y * w * np.sin(w * dt)
        mean = np.tile([0.0, (y1 - self.y) / dt], (4, 1))
        acceleration = np.tile([0.0, (v1 - v) / dt], (4, 1))
        self.y, self.v, self.done = y1, v1, self.done + substeps
        velocity = np.tile([0.0, v1], (4, 1))
        return Kinematics(self.reference + [0.0, y1], velocity, acceleration, mean, acceleration.copy())

    def state(self):
        return {"y": np.array([self.y]), "v": np.array([self.v])}

    def restore(self, state):
        self.y, self.v = float(state["y"][0]), float(state["v"][0])

    def check(self):
        pass

    def probe_values(self):
        return {"y": self.y}

    def frame(self):
        return Frame(self.reference + [0.0, self.y], {"velocity": np.tile([0.0, self.v], (4, 1))})

    def particles(self):
        return 4

    def steps(self):
        return self.done


class ToyWeight:
    """A fluid of nine ghosts that presses with a force of −`weight` and −`drag` times the mean velocity."""

    role = "fluid"

    def __init__(self, weight=3.0, drag=0.0):
        self.weight, self.drag, self.done, self.work = weight, drag, 0, 0.0
        axis = np.linspace(0.1, 0.9, 3)
        self.reference = np.array([[x, y] for y in axis for x in axis])

    def describe(self):
        numbers = {"density": 1.0, "sound_speed": 1.0, "support": 1.0}
        volume, body = np.full(9, 1.0 / 9.0), np.zeros(9, dtype=np.int64)
        return Description("fluid", "fluid", "toy", 0.01, 0.4, self.reference, volume, body, numbers)

    def _loads(self, velocity):
        force = np.column_stack([np.zeros(9), np.full(9, -self.weight / 9.0)]) - self.drag / 9.0 * velocity
        return Loads(np.full(9, self.weight), force)

    def begin(self, motion):
        return self._loads(motion.velocity)

    def stable_step(self):
        return 0.01

    def advance(self, t0, t1, substeps, boundary):
        self.done += substeps
        return self._loads(boundary.velocity_mean)

    def state(self):
        return {"done": np.array([self.done])}

    def restore(self, state):
        self.done = int(state["done"][0])

    def check(self):
        pass

    def probe_values(self):
        return {"weight": self.weight}

    def frame(self):
        return Frame(self.reference, {})

    def particles(self):
        return 9

    def steps(self):
        return self.done


@pytest.fixture
def toy_spring():
    return ToySpring


@pytest.fixture
def toy_weight():
    return ToyWeight


@pytest.fixture
def command(monkeypatch, capsys, tmp_path):
    """Runs `program words …` in this process and in an empty folder; returns exit code, standard output and errors."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shared.commands, "on_stop_signals", lambda handler: None)

    def run(program, *words):
        main = importlib.import_module(f"{program}.cli").main
        monkeypatch.setattr(sys, "argv", [program, *map(str, words)])
        with pytest.raises(SystemExit) as end:
            main()
        return end.value.code, *capsys.readouterr()

    return run
