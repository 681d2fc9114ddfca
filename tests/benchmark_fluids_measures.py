"""What the fluids' benchmark takes from finished runs: figures of probes and of frames."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from shared.expected_speed import sound_speed
from shared.run.probes import read_probes
from shared.run.statistics import statistic
from shared.run.vtkhdf import read_frame
from shared.schema.scene import Scene

NEIGHBOURS = 12  # nearest particles through whose pressures a plane is laid
INSIDE = (
    2.3  # of dx: a particle whose twelfth neighbour is farther is at the surface, a wall, or in spray; 2 to 2.2 inside
)


@dataclass(frozen=True)
class Found:
    """A finished run: its scene, its folder, result.json, probe times (n,) and histories."""

    scene: Scene
    folder: Path
    result: dict
    time: np.ndarray
    probes: dict[str, np.ndarray]

    @classmethod
    def of(cls, scene: Scene, folder: Path) -> Found:
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        return cls(scene, folder, result, *read_probes(folder / "probes.csv"))

    def frame(self, index: int):
        """Frame number `index`, negative from the end."""
        return read_frame(self.folder / "fluid.vtkhdf", index)[1]


def of_probe(probe: str, name: str, between=None, over: float = 1.0):
    """Statistic `name` of a probe, divided by `over`; means from the scene's average_from on."""

    def measure(found: Found) -> float:
        interval = between
        if interval is None and name == "mean":
            interval = (found.scene.output.average_from, float(found.time[-1]))
        return statistic(name, found.time, found.probes[probe], interval) / over

    return measure


def worst_reference(found: Found) -> float:
    """Largest distance of a reference's computed value from its value."""
    return max(abs(row["computed"] - row["value"]) for row in found.result["references"])


# ---- still_tank --------------------------------------------------------------------------------------------------


def depth_of(scene: Scene) -> float:
    """Nominal depth [m] of a rectangle of water."""
    return scene.fluid.bodies[0].rectangle[3]


def settled_level(scene: Scene) -> float:
    """Level [m] of the settled compressible column, (c²/g) ln(1 + gH/c²)."""
    g, c = abs(scene.gravity[1]), sound_speed(scene)
    return c**2 / g * math.log1p(g * depth_of(scene) / c**2)


def pressure_error(found: Found) -> float:
    """L2 error of the pressure over all particles, over its own norm, mean over the frames after average_from."""
    scene = found.scene
    g, c, level = abs(scene.gravity[1]), sound_speed(scene), settled_level(scene)
    first = math.ceil(scene.output.average_from / scene.end_time * scene.output.frames)
    errors = []
    for index in range(first, scene.output.frames + 1):
        frame = found.frame(index)
        exact = scene.fluid.density * c**2 * np.expm1(g * (level - frame.position[:, 1]) / c**2)
        errors.append(np.linalg.norm(frame.fields["pressure"] - exact) / np.linalg.norm(exact))
    return float(np.mean(errors))


def level_off(found: Found) -> float:
    """Mean level less the settled column's, in dx."""
    return (of_probe("level", "mean")(found) - settled_level(found.scene)) / found.scene.fluid.dx


def centre_off(found: Found) -> float:
    """How far the centre of mass moved from the settled column's, in dx."""
    first, last = found.frame(0).position[:, 1], found.frame(-1).position[:, 1]
    return float(last.mean() - first.mean()) / found.scene.fluid.dx


def kinetic_share(found: Found) -> float:
    """Largest kinetic energy after average_from over the column's potential energy ρgH²W/2."""
    scene = found.scene
    width = scene.fluid.bodies[0].rectangle[2]
    energy = 0.5 * scene.fluid.density * abs(scene.gravity[1]) * depth_of(scene) ** 2 * width
    interval = (scene.output.average_from, float(found.time[-1]))
    return statistic("max", found.time, found.probes["kinetic_energy"], interval) / energy


# ---- dam breaks --------------------------------------------------------------------------------------------------


def energy_rise(found: Found) -> float:
    """Largest rise of total energy between two frames, over its first value."""
    times = np.linspace(0.0, found.scene.end_time, found.scene.output.frames + 1)
    energy = np.interp(times, found.time, found.probes["total_energy"])
    return float(max(0.0, np.diff(energy).max()) / energy[0])


def impulse(until: float):
    """Impulse [N s/m] on the far wall up to `until` [s]: the probe holds the mean over each window."""

    def measure(found: Found) -> float:
        steps = np.diff(found.time, prepend=0.0)
        return float(np.sum((found.probes["wall_force"] * steps)[found.time <= until + 1e-9]))

    return measure


def peak(probe: str, span: float):
    """Largest mean over `span` [s] of a probe."""

    def measure(found: Found) -> float:
        count = max(1, round(span / (found.time[2] - found.time[1])))
        return float(np.convolve(found.probes[probe], np.full(count, 1.0 / count), "valid").max())

    return measure


def front_gap(found: Found, finest: Found) -> float:
    """Largest distance [m] between two runs' fronts until 0.35 s."""
    shared = np.linspace(0.0, 0.35, 141)
    return float(np.abs(np.subtract(*(np.interp(shared, f.time, f.probes["front_x"]) for f in (found, finest)))).max())


# ---- model against model -----------------------------------------------------------------------------------------


def disorder(found: Found) -> float:
    """Spread (standard deviation over mean) of the distance to the nearest particle, inside, in the last frame."""
    distance, _, inside = _neighbours(found)
    return float(distance[inside, 1].std() / distance[inside, 1].mean())


def pressure_noise(found: Found) -> float:
    """Root mean square distance [Pa] of pressures from a plane through the neighbours', inside, in the last frame."""
    _, index, inside = _neighbours(found)
    frame = found.frame(-1)
    at, p = frame.position[index[inside]], frame.fields["pressure"][index[inside]]
    arms = (at[:, 1:] - at[:, :1]) / found.scene.fluid.dx
    columns = np.concatenate([np.ones((*arms.shape[:2], 1)), arms], axis=2)
    normal = np.einsum("nki,nkj->nij", columns, columns)
    right = np.einsum("nki,nk->ni", columns, p[:, 1:])
    plane = np.linalg.solve(normal, right[..., None])[:, 0, 0]
    return float(np.sqrt(np.mean((p[:, 0] - plane) ** 2)))


def _neighbours(found: Found):
    """Distances and indices (n, 1 + NEIGHBOURS) of the nearest particles, itself first, and which are inside."""
    position = found.frame(-1).position
    distance, index = cKDTree(position).query(position, 1 + NEIGHBOURS)
    return distance, index, distance[:, -1] < INSIDE * found.scene.fluid.dx


def cost(found: Found) -> float:
    """Core seconds of stepping per simulated second."""
    return found.result["cost"]["fluid"]["stepping_core_s"] / found.scene.end_time
