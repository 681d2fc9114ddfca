"""The plate's first swing in its water: how fast it is, and how it comes to rest.

Water that moves along makes the mass m times the plate's own: the frequency falls to f/√m, and solid.damping, which
holds the plate alone, to η/m. From water too deep for its sound (Helmholtz) nothing comes back in time: the swing is
the dry one, and each wetted side takes its energy at the rate b = ρ c0/(ρ_s t). The pulse that left the plate as it
yielded is back from the water's surface after 2 H/c0, and again and again, turned over each time: it moves the plate
by 2 b/ω² times its deflection, over time. A column whose far end sends R < 1 of a pulse back, turned over below 0,
takes energy from a slow swing at the rate b (1 + R)/(1 − R), and as a mass it counts −4 R/(1 − R)² times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight.finding import of_particles
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import goals_quantity
from shared.geometry.regions import corners_of
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.scene import Scene

RADIATES = math.pi / 2.0  # depth in radians of sound: a quarter wave
ECHO = 1.5  # of what a plate that moves as one would feel of an echo: found up to 1.2
PULSE = 3.0  # length of an echo, in times of the plate's creep


@dataclass(frozen=True)
class Swing:
    """`omega` [rad/s] undamped; `damping` η [1/s]; `moved`: mass that swings, over the plate's own; `echo` [s]: what an
    echo of the start adds to the time integral of the deflection, over the deflection, every time `back` [s]."""

    omega: float
    damping: float
    moved: float = 1.0
    echo: float = 0.0
    back: float = math.inf

    @property
    def creep(self) -> float:
        """Rate [1/s] at which it comes to rest: η/2, or, damped beyond return, η/2 − √(η²/4 − ω²)."""
        half, omega = 0.5 * self.damping, self.omega
        # the second as a quotient: the difference of like numbers would be nothing
        return half if half < omega else omega**2 / (half + math.sqrt(half**2 - omega**2))

    def left(self, time: float) -> float:
        """Share of it that is left after a `time` [s]."""
        return math.exp(-self.creep * time)

    def echoed(self, start: float, end: float) -> float:
        """What echoes leave in a mean over `start` … `end` [s], over the deflection: two take each other away, one that
        is odd or cut by an end of the interval does not."""
        if not self.echo:
            return 0.0
        (before, cut), (until, late) = divmod(start / self.back, 1.0), divmod(end / self.back, 1.0)
        wide = PULSE / (self.creep * self.back)
        odd = (until - before) % 2 or (before and cut < wide) or (until and late < wide)
        return ECHO * self.echo / (end - start) if odd else 0.0


def swing(scene: Scene, n: Numbers) -> Swing | None:
    """Of the plate in its water; None where no frequency is known, as of a plate that a box of water holds."""
    plate, joint = n.plate, n.joint
    if plate is None or plate.frequency is None or (of_particles(n) and n.water.boxed and joint.closes):
        return None
    omega = 2.0 * math.pi * plate.frequency / math.sqrt(1.0 + plate.sheared)
    if joint is None or n.water.model == "still":
        return Swing(omega, plate.damping)
    if joint.wet_frequency is None:  # no sound in it: a sprung body that water flows round
        return Swing(omega / math.sqrt(joint.moved), plate.damping / joint.moved, joint.moved)
    carried = max(plate.wet, 1) * n.water.density * n.water.sound_speed / (plate.density * plate.thickness)
    reflected = scene.fluid.column.reflection if n.water.model == "column" and carries_sound(scene) else 1.0
    if reflected == 0.0 or (reflected < 1.0 and late(scene, n) <= RADIATES):
        comes_back = -reflected if scene.fluid.column.far_end == "open" else reflected
        moved = 1.0 + max(-4.0 * comes_back / (1.0 - comes_back) ** 2, 0.0) * (joint.moved - 1.0)
        carried *= (1.0 + comes_back) / (1.0 - comes_back)
        return Swing(omega / math.sqrt(moved), (plate.damping + carried) / moved, moved)
    if late(scene, n) > RADIATES:
        back = 2.0 * joint.depth / n.water.sound_speed
        return Swing(omega, plate.damping + carried, 1.0, 2.0 * carried / omega**2, back)
    return Swing(omega * joint.wet_frequency / plate.frequency, plate.damping / joint.moved, joint.moved)


def sounding(scene: Scene, n: Numbers) -> float:
    """Depth of the water in radians of sound at the plate's frequency in incompressible water, 2π f H/c0; 0 where
    nothing is late, as in a closed column, whose spring is its sound."""
    closed = scene.fluid is not None and scene.fluid.model == "column" and scene.fluid.column.far_end == "closed"
    if n.joint is None or n.joint.wet_frequency is None or closed or not carries_sound(scene):
        return 0.0
    return 2.0 * math.pi * n.joint.wet_frequency * n.joint.depth / n.water.sound_speed


def late(scene: Scene, n: Numbers) -> float:
    """The same over the way into the water that the swing is felt, which is short where water flows round the plate."""
    return sounding(scene, n) * n.joint.reach / n.joint.depth if n.joint is not None else 0.0


def radiates(scene: Scene, n: Numbers) -> bool:
    """Whether sound crosses the water too slowly for the plate to feel its mass."""
    return sounding(scene, n) > RADIATES


def dragged(scene: Scene, n: Numbers) -> float:
    """Depth of the layer of water that artificial viscosity drags along with a plate that it flows round, over the
    plate's length, of a sprung body by the water's share of what swings; 0 of water that moves along as a column."""
    if _flowed_round(n):
        layer = n.water.dragged_layer(swing(scene, n).omega) / n.plate.length
        return layer * (1.0 - 1.0 / n.joint.moved)
    swings = n.joint is not None and n.joint.wet_frequency is not None and n.plate.clamps
    if not swings or not of_particles(n) or not n.water.rests or n.joint.closes:
        return 0.0
    return n.water.dragged_layer(2.0 * math.pi * n.joint.wet_frequency) / n.plate.length


def _flowed_round(n: Numbers) -> bool:
    """Whether a sprung body swings in water of particles that flows round it."""
    sprung = n.joint is not None and n.plate.model == "spring" and n.plate.wet >= 2 and n.plate.frequency is not None
    return sprung and of_particles(n) and n.water.rests and not n.joint.closes and not n.joint.parts


def resounding(scene: Scene, n: Numbers) -> float:
    """Depth in radians of sound at a swing, of water that flows round a sprung body: π/2 where a standing wave of sound
    swings as fast, of half a length between two walls, of a quarter below the surface; 0 of other bodies."""
    if not _flowed_round(n):
        return 0.0
    axis = {"x": 0, "y": 1}.get(goals_quantity(scene).rpartition("-")[2], 1)
    extent = float(np.ptp(corners_of(scene.fluid.bodies)[:, axis])) * (1.0 if scene.gravity[axis] else 0.5)
    return swing(scene, n).omega * extent / n.water.sound_speed


def carries_sound(scene: Scene) -> bool:
    """Whether the fluid is compressible."""
    fluid = scene.fluid
    return fluid.model in PARTICLE_FLUIDS or (fluid.model == "column" and fluid.column.compressible)
