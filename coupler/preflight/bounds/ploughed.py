"""What a table moves through water of particles that has it on all sides.

Particles that nothing shifts (wcsph) give way to it by 2.4 to 2.9 dx where the kernel's support is 3.2 to 4 dx; then
they are pressed into it, and its forces jump to up to five times their size, whatever the time step, the speed and the
cut of tension. With a support of 2.6 dx forces stay smooth, and with ctvf (a cylinder and a square 16 dx wide, half a
metre deep, at 1, 5 and 20 m/s²).
"""

from __future__ import annotations

import numpy as np

from shared.geometry.regions import corners_of
from shared.geometry.shakers import shakers
from shared.kernels import kernel_named
from shared.schema.scene import Scene

_LOOSE = 2.8  # support over dx up to which particles give way
_WAY = 2.0  # dx; a square moved to and fro by 1.2 either way is not pressed on, by 1.5 its push is 70 % too large


def ploughed(scene: Scene) -> bool:
    """Whether particles are pressed into what is moved through them, past walls that stand."""
    fluid = scene.fluid
    fewer = kernel_named(fluid.kernel).support * fluid.h_over_dx <= _LOOSE
    if fluid.model != "wcsph" or fewer or not any(wall.motion is None for wall in scene.walls):
        return False
    water = corners_of(fluid.bodies)
    low, high = water.min(axis=0), water.max(axis=0)
    far = [one.points for one in shakers(scene) if one.span > _WAY * fluid.dx]
    return any(bool(np.all(points > low) and np.all(points < high)) for points in far)
