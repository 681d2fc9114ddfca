"""Small scenes that tests vary."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from shared.scene.reading import load_scene
from shared.schema.scene import Scene

TINY_COUPLED = """\
schema = 1
title = "A little water on a thin plate"
end_time = {end_time}
gravity = [0.0, -9.81]

[fluid]
model = "{fluid}"
dx = 4.0e-3
bodies = [{{ name = "water", rectangle = [0.0, 0.0, 0.1, 0.06] }}]

[[walls]]
name = "left"
polyline = [[0.0, 0.12], [0.0, -0.012]]

[[walls]]
name = "right"
polyline = [[0.1, -0.012], [0.1, 0.12]]

[solid]
model = "{solid}"
dx = {solid_dx}
density = 1200.0
youngs_modulus = 1.0e8
poisson_ratio = 0.3
damping = 500.0
bodies = [{{ name = "plate", rectangle = [0.0, -0.012, 0.1, 0.0] }}]
clamps = [{{ body = "plate", face = "left" }}, {{ body = "plate", face = "right" }}]

[[probes]]
name = "mid_y"
body = "plate"
point = [0.05, -0.006]
quantity = "displacement-y"

[[probes]]
name = "bottom"
point = [0.05, 0.004]
quantity = "pressure"

[[probes]]
name = "load_y"
body = "plate"
quantity = "force-y"

[output]
frames = 5
average_from = {average_from}
"""


SPRUNG = """
schema = 1
title = "1 m of water on a sprung block"
end_time = 0.9
gravity = [0.0, -9.81]
[fluid]
model = "column"
dx = 0.05
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.2, 1.0] }]
column = { far_end = "open", compressible = false }
[solid]
model = "spring"
dx = 0.05
density = 2000.0
spring = { stiffness = [1e9, 5e4, 1e9], damping = [0.0, 0.0, 0.0] }
bodies = [{ name = "block", rectangle = [0.0, -0.1, 0.2, 0.0] }]
[output]
probe_interval = 0.01
[[probes]]
name = "y"
quantity = "displacement-y"
body = "block"
point = [0.1, 0.0]
"""
"""Water that moves with a rigid body as one."""


def scene_of(text: str, folder: Path, sets: Sequence[str] = ()) -> Scene:
    """The scene of a `text`, written to `folder`, changed by `sets`."""
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return load_scene(path, sets)


def tiny_coupled(
    folder: Path,
    *,
    end_time: float = 0.02,
    fluid: str = "ctvf",
    solid: str = "total-lagrangian",
    solid_dx: float = 2.0e-3,
) -> Path:
    """A coupled scene of 375 fluid particles, written to `folder`; a few seconds a simulated 0.1 s."""
    path = folder / "tiny.toml"
    path.write_text(
        TINY_COUPLED.format(
            end_time=end_time, average_from=0.25 * end_time, fluid=fluid, solid=solid, solid_dx=solid_dx
        )
    )
    return path
