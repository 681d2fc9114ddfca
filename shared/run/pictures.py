"""Pictures of a run: its last frame, and each probe against its references (see probe_plots.py).

The last frame shows the fluid by its speed (by its pressure while it is all but at rest), the solid by its von
Mises stress, and the walls. Particles are drawn as large as they are, so that they tile.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection

from shared.contract import BadInput, Frame
from shared.geometry.motion_table import MotionTable
from shared.geometry.regions import outline
from shared.geometry.wall_chains import segments_of
from shared.run.drawing import FAINT, FONT_PT, INK, axes_at, largest_size, new_figure, save, si_scale
from shared.run.probe_plots import draw_probes
from shared.run.vtkhdf import read_frame
from shared.schema.fluid import Wall
from shared.schema.scene import Scene

_LONGEST_IN, _TALLEST_IN = 6.5, 6.5  # of the axes
_LEFT_IN, _BOTTOM_IN, _TOP_IN, _RIGHT_IN = 0.75, 0.6, 0.5, 0.25
_BAR_IN, _BAR_STEP_IN, _LEAST_BAR_IN = 0.14, 0.85, 1.8
_LYING_BAR_STEP_IN = 0.6
_TILING = 1.45  # diameter over spacing: discs on a square lattice cover it from √2 on
_LEAST_DISC_PT = 0.5
_AT_REST = 0.05  # of √(gL): below this speed the fluid is coloured by its pressure
_SPRAY = 0.003  # share of the fluid at each end of each axis that may lie outside the picture
_VISIBLE = 0.01  # of a solid's length: smaller deflections are drawn magnified to _MAGNIFIED
_MAGNIFIED = 0.06
_MARGIN = 0.03  # of the view, around it


@dataclass(frozen=True)
class _Cloud:
    """Particles to draw: `position` (n, 2) [m], `values` (n,) by which they are coloured, what these are."""

    position: np.ndarray
    values: np.ndarray
    spacing: float
    label: str
    unit: str
    colours: str


def draw_pictures(run_dir: Path, scene: Scene) -> list[Path]:
    """All pictures for which the run has the data: of a run that failed early there may be none."""
    frame = [draw_last_frame(run_dir, scene)] if _last_frames(Path(run_dir)) else []
    return [*frame, *draw_probes(run_dir, scene)]


def draw_last_frame(run_dir: Path, scene: Scene) -> Path:
    """Draw the last frame of both sides to last_frame.png. Raises BadInput if the run has no frames."""
    run_dir = Path(run_dir)
    frames = _last_frames(run_dir)
    if not frames:
        raise BadInput(f"{run_dir} holds no frames (fluid.vtkhdf, solid.vtkhdf) to draw.")
    time = max(time for time, _ in frames.values())
    magnification = 1.0
    clouds = []
    if "fluid" in frames:
        clouds.append(_fluid_cloud(frames["fluid"][1], scene))
    if "solid" in frames:
        cloud, magnification = _solid_cloud(frames["solid"][1], scene, alone="fluid" not in frames)
        clouds.append(cloud)
    walls = [_wall_lines(wall, time) for wall in scene.walls] if "fluid" in frames else []
    if "fluid" in frames and "solid" not in frames and scene.solid is not None:
        walls += [outline(body) for body in scene.solid.bodies]  # the partner held still
    bodies = [outline(body) for side in (scene.fluid, scene.solid) if side for body in side.bodies]
    something = walls or any(len(cloud.position) for cloud in clouds)
    lower, upper = _view(clouds, walls if something else bodies)
    words = f"t = {time:.4g} s" + (
        f", deflection × {magnification:_.0f}".replace("_", " ") if magnification != 1.0 else ""
    )
    return save(_figure(scene.title, words, clouds, walls, lower, upper), run_dir / "last_frame.png")


def _last_frames(run_dir: Path) -> dict[str, tuple[float, Frame]]:
    """Time and last frame of each side that has one."""
    frames = {}
    for side in ("fluid", "solid"):
        with contextlib.suppress(BadInput):  # not run, or ended before its first frame
            frames[side] = read_frame(run_dir / f"{side}.vtkhdf")
    return frames


# ---- what is drawn ----------------------------------------------------------------------------------------------


def _fluid_cloud(frame: Frame, scene: Scene) -> _Cloud:
    speed = np.hypot(*frame.fields["velocity"].T)
    free_fall = math.sqrt(math.hypot(*scene.gravity) * _length(frame.position))
    if "pressure" in frame.fields and len(speed) and np.quantile(speed, 0.99) < _AT_REST * free_fall:
        return _Cloud(frame.position, frame.fields["pressure"], scene.fluid.dx, "pressure", "Pa", "YlGnBu")
    return _Cloud(frame.position, speed, scene.fluid.dx, "fluid speed", "m/s", "viridis")


def _solid_cloud(frame: Frame, scene: Scene, alone: bool) -> tuple[_Cloud, float]:
    """The solid's particles, and by what factor their displacement is drawn (1 unless alone and too small to see)."""
    displacement = frame.fields["displacement"]
    length = _length(frame.position)
    largest = largest_size(displacement)
    factor = 1.0
    if alone and 0.0 < largest < _VISIBLE * length:
        factor = _round_down(_MAGNIFIED * length / largest)
    position = frame.position + (factor - 1.0) * displacement
    if "von_mises" in frame.fields:
        return _Cloud(position, frame.fields["von_mises"], scene.solid.dx, "von Mises stress", "Pa", "inferno"), factor
    size = np.hypot(*displacement.T)
    return _Cloud(position, size, scene.solid.dx, "displacement", "m", "inferno"), factor


def _wall_lines(wall: Wall, time: float) -> np.ndarray:
    """The wall's faces (k, 2, 2) [m] where its prescribed motion has brought them at `time` [s]."""
    faces = segments_of(wall)
    if wall.motion is None:
        return faces
    table = MotionTable(wall.motion)
    x, y, angle = table.displacements(np.array([time]))[0]
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return table.about + (faces - table.about) @ turn + (x, y)


def _length(position: np.ndarray) -> float:
    """The longer side of the box around points (n, 2) [m]; 0 without points."""
    inside = position[np.isfinite(position).all(axis=1)]
    return float(np.ptp(inside, axis=0).max()) if len(inside) else 0.0


def _view(clouds: list[_Cloud], lines: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner [m]: all lines and solids, and the fluid but for its farthest spray."""
    points = [line.reshape(-1, 2) for line in lines]
    for cloud in clouds:
        inside = cloud.position[np.isfinite(cloud.position).all(axis=1)]
        share = _SPRAY if cloud.label != "von Mises stress" else 0.0
        if len(inside):
            points.append(np.quantile(inside, [share, 1.0 - share], axis=0))
            points[-1] += [[-0.5 * cloud.spacing], [0.5 * cloud.spacing]]
    every = np.vstack(points)
    lower, upper = every.min(axis=0), every.max(axis=0)
    margin = _MARGIN * (upper - lower).max()
    return lower - margin, upper + margin


def _round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= value * (1.0 + 1e-9))


# ---- the figure -------------------------------------------------------------------------------------------------


def _figure(title: str, words: str, clouds: list[_Cloud], walls: list[np.ndarray], lower, upper):
    """Axes in true proportion with a colour bar per cloud: beside them, or below where they are low."""
    extent = upper - lower
    scale = min(_LONGEST_IN / extent[0], _TALLEST_IN / extent[1])  # inches per metre
    width, height = extent * scale
    beside = height >= _LEAST_BAR_IN
    below = 0.0 if beside else len(clouds) * _LYING_BAR_STEP_IN
    right = len(clouds) * _BAR_STEP_IN if beside else _RIGHT_IN
    figure = new_figure(_LEFT_IN + width + right, _BOTTOM_IN + below + height + _TOP_IN)
    axes = axes_at(figure, _LEFT_IN, _BOTTOM_IN + below, width, height)
    unit_length, unit = si_scale(largest_size(np.array([lower, upper])), "m")
    for number, cloud in enumerate(clouds):
        inches = (
            (_LEFT_IN + width + 0.15 + number * _BAR_STEP_IN, _BOTTOM_IN, _BAR_IN, height)
            if beside
            else (_LEFT_IN, 0.45 + (len(clouds) - 1 - number) * _LYING_BAR_STEP_IN, width, _BAR_IN)
        )
        points_per_metre = 72.0 * scale
        disc = max(_TILING * cloud.spacing * points_per_metre, _LEAST_DISC_PT)
        _draw_cloud(figure, axes, cloud, disc, unit_length, inches, "vertical" if beside else "horizontal")
    for lines in walls:
        axes.add_collection(LineCollection(lines / unit_length, colors=INK, linewidths=1.2, capstyle="round"))
    axes.set(xlim=(lower[0] / unit_length, upper[0] / unit_length))
    axes.set(ylim=(lower[1] / unit_length, upper[1] / unit_length))
    axes.set_xlabel(f"x [{unit}]", fontsize=FONT_PT, color=INK)
    axes.set_ylabel(f"y [{unit}]", fontsize=FONT_PT, color=INK)
    axes.set_title(title, loc="left", fontsize=FONT_PT + 1, color=INK)
    axes.set_title(words, loc="right", fontsize=FONT_PT, color=FAINT)
    return figure


def _draw_cloud(figure, axes, cloud: _Cloud, disc: float, unit_length: float, inches, orientation: str) -> None:
    """Discs of diameter `disc` [pt] and their colour bar at `inches`."""
    factor, unit = si_scale(largest_size(cloud.values), cloud.unit)
    values = cloud.values / factor
    low, high = (0.0, 1.0) if len(values) == 0 else np.quantile(values, [0.002, 0.998])
    if cloud.label != "pressure":
        low = 0.0
    discs = axes.scatter(
        *(cloud.position / unit_length).T,
        c=values,
        s=disc**2,
        cmap=cloud.colours,
        vmin=low,
        vmax=max(high, low + 1e-12),
        linewidths=0,
    )
    bar = figure.colorbar(discs, cax=axes_at(figure, *inches), orientation=orientation)
    bar.outline.set(linewidth=0.6, edgecolor=FAINT)
    bar.set_label(f"{cloud.label} [{unit}]", fontsize=FONT_PT, color=INK)
