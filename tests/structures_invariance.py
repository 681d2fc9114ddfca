"""The same structure seen otherwise, for tests and benchmark: turned, mirrored, in other units, through tracers."""

from __future__ import annotations

import math

import numpy as np

from shared.scene.reading import load_scene
from shared.schema.scene import Scene
from solid_solver.models import make_model
from solid_solver.updated_fields import E0, E1, U, V, X, Y
from tests.updated_models import jittered

_ANGLE = math.radians(30.0)
_TURN = np.array([[math.cos(_ANGLE), -math.sin(_ANGLE)], [math.sin(_ANGLE), math.cos(_ANGLE)]])

VIEWS = {
    "turned by 30°": (_TURN, {}),
    "mirrored": (np.diag([-1.0, 1.0]), {}),
    "in mm, mg, ms": (np.eye(2), {"length": 1e3, "time": 1e3, "mass": 1e6}),
}
"""A rotation or a mirror image, and factors on the numbers by other units."""

END, STEPS = 0.05, 1200  # s; steps of one length: what rounding does to the stable step must not tell


def changed(scene: Scene, turn: np.ndarray, length=1.0, time=1.0, mass=1.0) -> Scene:
    """A cantilever's scene turned by the matrix `turn` (a rotation or a mirror image), in other units."""
    data = scene.model_dump(by_alias=True, exclude_none=True)
    solid, body = data["solid"], data["solid"]["bodies"][0]
    x0, y0, x1, y1 = body.pop("rectangle")
    corners = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    if np.linalg.det(turn) > 0.0:
        body["rectangle"] = [length * x for x in (x0, y0, x1, y1)]
        body["rotate"] = {"angle": math.degrees(math.atan2(turn[1, 0], turn[0, 0])), "about": [0.0, 0.0]}
    else:  # a mirror in x: the face that was left is right
        mirrored = length * corners @ turn.T
        body["rectangle"] = [*mirrored.min(axis=0), *mirrored.max(axis=0)]
        solid["clamps"][0]["face"] = "right"
    data["gravity"] = tuple(length / time**2 * turn @ np.array(data["gravity"]))
    solid["dx"] *= length
    solid["density"] *= mass / length**2  # per unit of depth, which keeps its unit
    solid["youngs_modulus"] *= mass / time**2
    solid["damping"] /= time
    data["end_time"] *= time
    for probe in data["probes"]:
        probe["point"] = tuple(length * turn @ np.array(probe["point"]))
    return Scene.model_validate(data)


def tip_of_cantilever(model: str, turn: np.ndarray, **units) -> np.ndarray:
    """Tip displacement (2,) [m] of cantilever_gravity after END, computed in another view and turned back."""
    scene = load_scene("cantilever_gravity", [f"solid.model={model}", "solid.dx=5e-3"])
    data = scene.model_dump(by_alias=True, exclude_none=True)
    kept = [p for p in data["probes"] if p["quantity"].startswith("displacement")]
    scene = Scene.model_validate(data | {"probes": kept, "references": [], "goal": None})
    one = make_model(changed(scene, turn, **units), False, 1)
    one.begin(None)
    one.advance(0.0, END * units.get("time", 1.0), STEPS, None)
    found = one.probe_values()
    return turn.T @ np.array([found["tip_x"], found["tip_y"]]) / units.get("length", 1.0)


def changed_answer(model: str, view: str) -> float:
    """How far the answer of a view of VIEWS is from the plain one, relative."""
    turn, units = VIEWS[view]
    plain = tip_of_cantilever(model, np.eye(2))
    return float(np.linalg.norm(tip_of_cantilever(model, turn, **units) - plain) / np.linalg.norm(plain))


def tracer_error(steps=100, shifting=True) -> float:
    """Largest distance of tracers from the material in an affine flow over the spacing, while particles shift.

    Each step takes places and offsets by F = I + Δt A of u = A x: tracers end on the affine image of their start.
    """
    model, flow, dt = jittered(0.3, shifting=shifting), np.array([[0.02, -0.3], [0.4, 0.03]]), 0.01
    own = model._slot
    exact = model._S[X : Y + 1, own].copy()
    for _ in range(steps):
        model._S[U : V + 1, own] = flow @ model._S[X : Y + 1, own]
        model._at_once(dt)
        exact = exact + dt * flow @ exact
    assert shifting == (np.abs(model._S[E0 : E1 + 1, own]).max() > 0.0)
    return float(np.max(np.hypot(*(model._published()[0].T - exact))) / model._scene.solid.dx)
