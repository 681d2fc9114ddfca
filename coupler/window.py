"""What `auto` chooses before a run: the scheme, and the window's length, from the stability of the lagged exchange.

α = ρ_f c Δt/(ρ_s t) and r = ρ_f H/(ρ_s t) say how much of a change of load comes back as load within a window:
|g| ≈ min(α/2, r), the mass of the water that sound reaches, over the structure's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from shared.contract import Description
from shared.geometry.regions import own_size
from shared.schema.coupling import Coupling
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS

LARGEST_ALPHA = 0.07
"""Largest α of an automatic window without iteration. On an absorbing column the serial protocol holds up to 2, 1.155
and 0.709 for predictor order 0, 1, 2; a column that reflects sound is pumped by the lag long before: measured on 60 mm
of water on a plate a fifth of its weight, α 0.14 grows and 0.07 decays, whatever the order; on hydrostatic_plate, where
nothing but the water's viscosity damps, energy made is 19 % of the work within 60 ms at 0.067, 65 % in 52 at 0.076."""
_LARGEST_PARALLEL_ALPHA = (0.04, 0.016, 0.005)
"""The same where both sides work at once, by predictor order: there a column that reflects nine tenths is pumped as
fast as at 0.07 by the serial protocol (`stability.theory.acoustic`, r from 2 to 15). Measured on 0.2 m of water between
walls on an elastic floor, order 2: 0.07 is past the ledger's limit within 31 ms."""
_LARGEST_LAYER_ALPHA = 0.5
"""Largest α of the structure's outermost layer of particles, ρ_f c Δt/(ρ_s dx), in an automatic window. Waves along the
face whose quarter period is shorter than the lag are pushed on where they should radiate: a ripple of 6 dx. Measured on
dam_break_plate: 0.41, one fluid step, holds for 1.0 s; 0.82 makes 0.8 % of the work by 0.2 s and ripples from 0.45 s
on, past the ledger's limit at 0.56 s; 1.23 makes 5 %, 1.64 as much as the work by 0.2 s. Letting the face radiate
within the window, by a load −ρ_f c (v − v̄) with v̄ the mean of the window before, stills the ripple at 1.1 and 1.7, but
there drops that strike the plate, which the lag shows a rigid wall, still make 9 and 12 % of the work by 0.5 s."""
_STIFF = 0.1
"""Ratio of acoustic impedances ρ_f c/(ρ_s c_p) below which its neighbours hold a layer and it has no say."""
_MOST_STEPS = 4
"""Fluid steps in an automatic window: enough to make the exchange cheap beside the steps, few enough to be accurate."""
SPEED_UP = 0.2
"""Speed over c0 at which neighbours meet that is expected of the flow: the window holds whole fluid steps at this speed
(shared/fluid_step.py), so that few windows are cut into one step more, which doubles what a window of one step costs.
Measured on dam_break_plate at dx 1e-3: 0.05 to 0.1 until 0.3 s, past 0.2 for a twelfth of the time, when the jet
strikes the far wall; steps to 0.7 s are fewest from 0.2 to 0.25."""
_COLUMN_ALPHA = 0.25
"""Largest α of an automatic window that is iterated on model column under a structure that can move: a column loses
nothing, and modes of the plate that are faster than the window draw energy from the motion that is rebuilt inside it.
Measured on a metre of water on a steel floor, to 0.2 s: 0.19 to 0.32 hold, 0.38 and 0.5 grow, 0.57 holds (what grows is
in step with the window), 1.1 grows, 2.1 blows up. A sprung piston on a closed column needs it to be followed at all."""
_SHORTEST = 1.0 / 3.0
"""Of a fluid step: before an automatic window gets shorter, iterating costs less than the steps that it would add."""


@dataclass(frozen=True)
class Plan:
    """Scheme and window [s] of a run, and why."""

    scheme: str
    window: float
    reasons: list[str] = field(default_factory=list)


def largest_alpha(scheme: str, predictor: int) -> float:
    """Largest α of an automatic window that is taken once."""
    return _LARGEST_PARALLEL_ALPHA[predictor] if scheme == "parallel-explicit" else LARGEST_ALPHA


def alpha_rate(fluid: Description, structure: Description) -> float:
    """α per second of window: ρ_f c/(ρ_s t) [1/s], t the thickness of the thinnest body; 0 where nothing carries
    sound, or where the structure moves as it was told."""
    f, s = fluid.numbers, structure.numbers
    if structure.model == "rigid":
        return 0.0
    return f["density"] * f.get("sound_speed", 0.0) / (s["density"] * s["thickness"])


def mass_ratio(scene: Scene, structure: Description) -> float:
    """r = ρ_f H/(ρ_s t), H the largest extent of the water."""
    depth = max(float(own_size(body).max()) for body in scene.fluid.bodies)
    return scene.fluid.density * depth / (structure.numbers["density"] * structure.numbers["thickness"])


def window_length(coupling: Coupling, fluid: Description, structure: Description) -> float:
    """The window [s] of an explicit scheme: as the scene says, or `auto`: up to four fluid steps with α at most
    `largest_alpha`, and 0.5 for a soft structure's outermost layer."""
    if coupling.window != "auto":
        return coupling.window
    step = fluid.stable_step / (1.0 + SPEED_UP)
    rate = alpha_rate(fluid, structure)
    longest = largest_alpha(coupling.scheme, coupling.predictor) / rate if rate > 0.0 else math.inf
    layer = rate * structure.numbers["thickness"] / structure.spacing
    if structure.model in PARTICLE_MODELS and layer * structure.spacing > _STIFF * structure.numbers["wave_speed"]:
        longest = min(longest, _LARGEST_LAYER_ALPHA / layer)
    return step * min(int(min(longest / step, _MOST_STEPS)), _MOST_STEPS) if longest > step else longest


def make_plan(
    coupling: Coupling, fluid: Description, structure: Description, r: float, longest: float = math.inf
) -> Plan:
    """Scheme and window of a run; `r`: the mass ratio; `longest` [s]: that an automatic window may be.

    An automatic window that is iterated holds one fluid step. Longer ones take more iterations, so that the fluid steps
    more (by a fifth at two, by 30 to 50 % at four, on a rubber gate and cantilever_in_water), and a drop of water that
    strikes a soft face turns it inside out at four.
    """
    rate = alpha_rate(fluid, structure)
    window = window_length(coupling, fluid, structure)
    step = fluid.stable_step / (1.0 + SPEED_UP)
    iterated = step if coupling.window == "auto" else coupling.window
    if coupling.window == "auto":
        window, iterated = min(window, longest), min(iterated, longest)
    if coupling.window == "auto" and fluid.model == "column" and rate > 0.0:
        iterated = min(iterated, _COLUMN_ALPHA / rate)
    if coupling.scheme != "auto":
        return Plan(
            coupling.scheme,
            iterated if coupling.scheme.endswith("implicit") else window,
            [f"scheme {coupling.scheme}: the scene asks for it"],
        )
    if structure.model == "rigid":
        return Plan("serial-explicit", window, ["serial-explicit: the structure's motion is prescribed"])
    if fluid.model == "still":
        return Plan("serial-explicit", window, ["serial-explicit: water at rest answers to places alone"])
    response = min(0.5 * rate * window, r) if rate > 0.0 else r
    numbers = f"α = {rate * window:.3g}, r = {r:.3g}, expected response of the load to itself {response:.2g}"
    if coupling.window == "auto" and rate > 0.0 and window < _SHORTEST * step and r > 0.5 * LARGEST_ALPHA:
        why = (
            f"explicit exchange with α at most {LARGEST_ALPHA:g} would need a window of {window / step:.2g} fluid "
            f"steps (r = {r:.3g}); iterating over whole steps costs less"
        )
        return Plan("serial-implicit", iterated, [f"serial-implicit: {why}"])
    if response <= 0.5 * LARGEST_ALPHA * (1.0 + 1e-9):
        return Plan("serial-explicit", window, [f"serial-explicit: {numbers}, at most {LARGEST_ALPHA / 2:g}"])
    return Plan("serial-implicit", iterated, [f"serial-implicit: {numbers}"])
