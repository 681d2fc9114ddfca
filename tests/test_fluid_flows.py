"""Flows with exact answers at coarse resolution, and what is sampled of the fluid."""

import numpy as np
import pytest

from fluid_solver.fields import FLUID, M, P, U, V, X, Y
from fluid_solver.ghosts import lay_ghosts
from fluid_solver.initial import fluid_particles
from fluid_solver.models import make_model
from shared.contract import BadInput, Kinematics
from shared.kernels import kernel_named
from shared.run.statistics import statistic
from shared.scene.reading import load_scene
from tests.fluid_models import begun, fluid_rows, run, scene, tank


def history(model, time, rows, probe):
    """Times and values of a probe, `rows` of them over `time` [s]."""
    values = [model.probe_values()[probe]]
    for k in range(rows):
        run(model, time / rows, 1, time * k / rows)
        values.append(model.probe_values()[probe])
    return np.linspace(0.0, time, rows + 1), np.array(values)


@pytest.mark.slow
def test_vortices_decay_by_viscosity_alone():
    """Taylor-Green at 25 × 25: kinetic energy as exp(−16π²t/Re), and the mean pressure stays where it was."""
    model = begun(load_scene("taylor_green", ["fluid.dx=0.04"]))
    time, energy = history(model, 0.6, 12, "kinetic_energy")
    assert statistic("decay", time, energy, (0.2, 0.6)) == pytest.approx(16.0 * np.pi**2 / 100.0, rel=0.04)
    assert abs(fluid_rows(model, P)[0].mean()) < 2.0  # Pa; ρU²/2 is 500


@pytest.mark.slow
def test_a_wave_swings_and_decays_as_the_viscous_root_says():
    """Half the resolution that ships: period within 3 %, decay within 15 %."""
    model = begun(load_scene("standing_wave", ["fluid.dx=0.04"]))
    time, crest = history(model, 1.6, 80, "crest")
    assert statistic("wave-period", time, crest) == pytest.approx(0.818009, rel=0.03)
    assert statistic("wave-decay", time, crest) == pytest.approx(0.808048, rel=0.15)


def test_a_lid_drags_what_is_under_it():
    """Twenty particles across: once they tore off the lid in the corner that it slides away from, and all came to rest
    (u_13 0.14, energy 0.7 J/m by 8 s)."""
    model = begun(load_scene("lid_cavity", ["fluid.dx=0.05"]))
    run(model, 8.0, 4)
    values = model.probe_values()
    assert 0.6 < values["u_13"] < 0.8  # 0.737
    assert -0.22 < values["u_8"] < -0.12  # -0.206
    assert values["v_9"] < 0.0 < values["v_5"]
    assert values["kinetic_energy"] > 20.0


def test_honey_before_a_piston_flows_as_its_viscosity_wants():
    """A channel of width L, its piston at a speed U, Reynolds number 0.1: pressure falls by 12 μ U/L² per length. With
    ten times U for the speed of sound it was squeezed instead, until more than 20 % of its density was off."""
    plates = [[(0.06, 0.01), (-0.01, 0.01)], [(-0.01, 0.0), (0.06, 0.0)]]
    walls = [{"name": f"plate{k}", "polyline": line, "slip": "no"} for k, line in enumerate(plates)]
    motion = {"times": [0.0, 1.0], "translation": [(0.0, 0.0), (0.01, 0.0)]}
    walls.append({"name": "piston", "polyline": [(0.0, 0.01), (0.0, 0.0)], "motion": motion})
    at = {"near": 0.008, "far": 0.012}
    probes = [{"name": name, "quantity": "pressure", "point": (x, 0.005)} for name, x in at.items()]
    honey = [{"name": "honey", "rectangle": (0.0, 0.0, 0.02, 0.01)}]
    case = scene(honey, walls, (0.0, 0.0), probes=probes, dx=1e-3, h_over_dx=2.0, viscosity=1e-3, alpha=0.0)
    model = begun(case)
    run(model, 0.1, 2)
    values = model.probe_values()
    assert (values["near"] - values["far"]) / 0.004 == pytest.approx(12.0 * 1.0 * 0.01 / 0.01**2, rel=0.12)


def test_samples_are_exact_for_what_they_are_made_for():
    """Pressure of a linear field, velocity of a uniform one, the level of a settled column, on a wall too, its
    stored energy."""
    probes = [
        {"name": "p", "quantity": "pressure", "point": (0.11, 0.083)},
        {"name": "u", "quantity": "velocity-x", "point": (0.11, 0.083)},
        {"name": "surface", "quantity": "elevation", "point": (0.1, 0.15)},
        {"name": "at_wall", "quantity": "elevation", "point": (0.0, 0.15)},
        {"name": "none", "quantity": "elevation", "point": (5.0, 0.0)},
        {"name": "energy", "quantity": "total-energy"},
        {"name": "clipped", "quantity": "clipped-impulse"},
    ]
    table = tank().model_dump(by_alias=True) | {"probes": probes}
    model = make_model(type(tank()).model_validate(table), False, 1)
    S, fluid = model.store.S, model.store.kind == FLUID
    S[U, fluid] = 0.3
    values = model.probe_values()
    assert values["p"] == pytest.approx(1000.0 * 9.81 * (0.15 - 0.083), rel=0.02)
    assert values["u"] == pytest.approx(0.3, rel=1e-12)
    assert values["surface"] == pytest.approx(0.0, abs=0.002)
    assert values["at_wall"] == pytest.approx(values["surface"], abs=0.02 * model.c.dx)
    assert np.isnan(values["none"])
    weight = 1000.0 * 9.81 * 0.2 * 0.15
    assert values["energy"] == pytest.approx(weight * 0.075 + 0.5 * 0.3**2 * 30.0, rel=0.01)
    assert values["clipped"] == 0.0


def test_tension_is_cut_as_the_scene_says():
    """A square of water torn apart: its pressure ends at the limit, and what was cut is counted."""
    lowest = {}
    for choice in ("limited", "none", "free"):
        body = {"name": "water", "rectangle": (0.0, 0.0, 0.2, 0.2)}
        probes = [{"name": "clipped", "quantity": "clipped-impulse"}]
        case = scene([body], gravity=(0.0, 0.0), sound_speed=10.0, negative_pressure=choice, probes=probes)
        model = begun(case)
        S, fluid = model.store.S, model.store.kind == FLUID
        S[U, fluid] = 4.0 * (S[X, fluid] - 0.1)
        S[V, fluid] = 4.0 * (S[Y, fluid] - 0.1)
        run(model, 0.01)
        lowest[choice] = fluid_rows(model, P)[0].min(), model.probe_values()["clipped"]
    assert lowest["none"][0] == 0.0
    assert lowest["limited"][0] == pytest.approx(-0.01 * 1000.0 * 10.0**2)
    assert lowest["free"][0] < lowest["limited"][0]
    assert lowest["none"][1] > lowest["limited"][1] > 0.0 == lowest["free"][1]


def test_shaken_particles_carry_the_mass_and_stay_near_their_places():
    case = scene([{"name": "water", "rectangle": (0.0, 0.0, 0.1, 0.1)}], shake=0.2, initial_pressure="zero")
    still = case.model_copy(update={"fluid": case.fluid.model_copy(update={"shake": 0.0})})
    kernel, h = kernel_named(case.fluid.kernel), case.fluid.h_over_dx * case.fluid.dx
    shaken, rest = (fluid_particles(one, 10.0, lay_ghosts(one, kernel.support * h)) for one in (case, still))
    moved = np.abs(shaken.position - rest.position).max()
    assert 0.1 * 0.01 < moved <= 0.2 * 0.01
    assert np.array_equal(shaken.mass, rest.mass)


# ---- water at rest, thin plates -------------------------------------------------------------------------------------


def two_reservoirs(thickness, model="ctvf", dx=0.01):
    """0.3 m of water left of a plate that stands in a tank, 0.2 m right of it."""
    right = 0.2 + thickness
    bodies = [
        {"name": "left", "rectangle": (0.0, 0.0, 0.2, 0.3)},
        {"name": "right", "rectangle": (right, 0.0, right + 0.2, 0.2)},
    ]
    wall = {"name": "tank", "polyline": [(0.0, 0.45), (0.0, 0.0), (right + 0.2, 0.0), (right + 0.2, 0.45)]}
    solid = {
        "model": "rigid",
        "dx": 0.01,
        "density": 1000.0,
        "bodies": [{"name": "plate", "rectangle": (0.2, 0.0, right, 0.4)}],
    }
    probes = [{"name": "net", "quantity": "force-x", "body": "plate"}, {"name": "lost", "quantity": "leaked"}]
    return scene(bodies, [wall], solid=solid, model=model, dx=dx, probes=probes)


NET = 0.5 * 1000.0 * 9.81 * (0.3**2 - 0.2**2)


@pytest.mark.parametrize("thickness", [0.02, 0.03])
def test_a_thin_plate_feels_the_difference_of_its_two_waters(thickness):
    model = begun(two_reservoirs(thickness))
    time, net = history(model, 0.4, 20, "net")
    assert net[time > 0.2].mean() == pytest.approx(NET, rel=0.07)
    assert model.probe_values()["lost"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("model_name", ["ctvf", "wcsph"])
@pytest.mark.parametrize("dx", ["0.02", "0.01"])
def test_a_block_under_water_is_lifted_by_what_it_displaces(model_name, dx):
    """2 and 4 dx thick: within 1 % of Archimedes, a thousandth of what presses on its faces."""
    model = begun(load_scene("submerged_block", [f"fluid.model={model_name}", f"fluid.dx={dx}"]))
    time, lift = history(model, 0.8, 40, "lift")
    assert lift[time > 0.4].mean() == pytest.approx(1000.0 * 9.81 * 0.2 * 0.04, rel=0.01)


def test_a_sensor_averages_over_its_extent():
    """A field that is 1 kPa within 12 mm of a point and none beyond: a wide sensor reads less."""
    probes = [{"name": "point", "quantity": "pressure", "point": (0.1, 0.08)}]
    probes.append(probes[0] | {"name": "wide", "extent": 0.1})
    table = tank(gravity=(0.0, 0.0), sound_speed=10.0).model_dump(by_alias=True) | {"probes": probes}
    model = make_model(type(tank()).model_validate(table), False, 1)
    S = model.store.S
    S[P] = np.where(np.hypot(S[X] - 0.1, S[Y] - 0.08) < 0.012, 1000.0, 0.0)
    values = model.probe_values()
    assert 0.1 * values["point"] < values["wide"] < 0.5 * values["point"]


def test_force_on_a_wall_is_the_mean_over_the_window():
    """A jet that ends: force × window is the momentum that the fluid lost, however long the window."""
    jet = {"name": "jet", "rectangle": (0.005, 0.0, 0.055, 0.05), "velocity": (-1.0, 0.0)}
    wall = {"name": "wall", "polyline": [(0.0, 0.2), (0.0, -0.2)]}
    probes = [{"name": "push", "quantity": "force-x", "body": "wall"}]
    model = begun(scene([jet], [wall], gravity=(0.0, 0.0), sound_speed=15.0, probes=probes))
    before = M_U(model)
    model.advance(0.0, 0.02, int(np.ceil(0.02 / model.stable_step())), None)
    assert -model.probe_values()["push"] * 0.02 == pytest.approx(M_U(model) - before, rel=1e-9)
    assert M_U(model) - before > 0.5


def M_U(model) -> float:
    """Momentum along x [N s/m] of the fluid."""
    mass, u = fluid_rows(model, M, U)
    return float(mass @ u)


def test_a_plate_too_thin_for_two_waters_is_refused():
    with pytest.raises(BadInput, match="averag"):
        make_model(two_reservoirs(0.01), False, 1)


def test_still_water_is_the_weight_and_follows_the_face():
    model = begun(two_reservoirs(0.01, "still"), coupled=True)
    assert model.probe_values()["net"] == pytest.approx(NET, rel=1e-12)
    place = model.describe().position
    left = place[:, 0] < 0.205
    bent = place + np.c_[np.where(left, -0.05 * np.sin(np.pi * place[:, 1] / 0.4), 0.0), np.zeros(len(place))]
    load = model.advance(0.0, 1.0, 1, Kinematics.at_rest(bent))
    load = model.advance(1.0, 2.0, 1, Kinematics.at_rest(bent))
    taken = lambda h: 0.05 * 0.4 / np.pi * (1.0 - np.cos(np.pi * h / 0.4))  # noqa: E731  m² below h
    level = 0.3
    for _ in range(50):
        level = 0.3 + taken(level) / 0.2
    net = NET + 500.0 * 9.81 * (level**2 - 0.3**2)
    assert load.force[:, 0].sum() == pytest.approx(net, rel=1e-3)  # by its height alone, seen from the side
    y = np.linspace(0.0, level, 20001)
    lifted = np.trapezoid(1000.0 * 9.81 * (level - y) * 0.05 * np.pi / 0.4 * np.cos(np.pi * y / 0.4), y)
    assert abs(load.force[left, 1].sum()) == pytest.approx(abs(lifted), rel=0.01)


def test_mass_is_what_the_shape_holds():
    model = begun(load_scene("lid_cavity", ["fluid.dx=0.05"]))
    assert fluid_rows(model, M)[0].sum() == pytest.approx(1000.0, rel=1e-12)


def test_water_that_fills_a_turning_box_keeps_its_mean_pressure():
    """No wall that moved was taken to keep its room: the mean pressure grew, by 80 Pa in half a second of this."""
    times = [0.05 * k for k in range(21)]
    motion = {"times": times, "rotation": [180.0 * t * t for t in times]}
    corners = [(-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1), (0.1, 0.1)]
    wall = {"name": "box", "closed": True, "polyline": corners, "motion": motion}
    water = {"name": "water", "rectangle": (-0.1, -0.1, 0.1, 0.1)}
    model = begun(scene([water], [wall], gravity=(0.0, 0.0)))
    run(model, 0.5, 10)
    pressure, speed = fluid_rows(model, P, U)
    assert np.abs(speed).max() > 0.05
    assert abs(pressure.mean()) < 1.0
