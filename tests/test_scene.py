"""Reading scenes: every mistake is named, what is right survives the way to the file and back."""

import json
import os
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.contract import BadInput
from shared.run.curves import read_curve
from shared.scene.reading import dump_scene, load_scene, shipped_cases
from shared.scene.warnings import scene_warnings
from shared.schema.scene import Scene

GOOD = """
schema = 1
title = "plate in a tank"
end_time = 1.0
gravity = [0.0, -9.81]

[fluid]
model = "wcsph"
dx = 0.01
bodies = [{ name = "water", rectangle = [0.0, 0.0, 0.5, 0.5] }]

[[walls]]
name = "tank"
polyline = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]

[solid]
model = "total-lagrangian"
dx = 0.01
density = 1000.0
youngs_modulus = 1e6
bodies = [{ name = "plate", rectangle = [0.6, 0.0, 0.65, 0.3] }]
clamps = [{ body = "plate", face = "bottom" }]

[[probes]]
name = "tip"
quantity = "displacement-x"
body = "plate"
point = [0.625, 0.3]
"""


@pytest.fixture
def scene_file(tmp_path):
    def write(text=GOOD):
        path = tmp_path / "scene.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def mistakes(path, *sets):
    with pytest.raises(BadInput) as caught:
        load_scene(path, sets)
    assert caught.value.exit_code == 2
    return str(caught.value).splitlines()[1:]


def test_good_scene_loads_with_defaults(scene_file):
    scene = load_scene(scene_file())
    assert scene.fluid.h_over_dx == 1.3
    assert scene.coupling.scheme == "auto"
    assert scene_warnings(scene) == []


def test_five_mistakes_of_mixed_kinds_are_five_lines(scene_file):
    text = GOOD.replace('model = "wcsph"', 'model = "wscph"').replace("dx = 0.01\nbodies", "dxx = 0.01\nbodies")
    text = text.replace("youngs_modulus = 1e6", "youngs_modulus = -1e6").replace("[0.625, 0.3]", "[0.7, 0.3]")
    lines = mistakes(scene_file(text.replace('body = "plate", face', 'body = "plat", face')))
    assert len(lines) == 5
    text = "\n".join(lines)
    assert 'fluid.model = "wscph": must be "ctvf" or "wcsph" or "still" or "column"; did you mean \'wcsph\'?' in text
    assert "fluid.dxx: unknown key; did you mean 'dx'?" in text
    assert "solid.youngs_modulus = -1000000.0: must be a number > 0 [Pa]" in text
    assert "solid.clamps[0].body = \"plat\": no such body of the solid; did you mean 'plate'?" in text
    assert "probes[0].point = [0.7, 0.3]: 0.05 m outside body 'plate'" in text


WRONG = {
    "gravity=[0.0]": "gravity = [0.0]: must be two numbers [m/s²]",
    "end_time=true": "end_time = true: must be a number > 0 [s]",
    'fluid.dx="0.01"': 'fluid.dx = "0.01": must be a number > 0 [m]',
    "fluid.dx=nan": "must be a number > 0 [m]",
    "domain=3": 'domain = 3: must be { lower, upper } or "auto"',
    "probes.tip.name=" + 101 * "p": "must be a letter, then up to 99 letters, digits, _ or -",
    "walls={}": "walls: must be a list of tables; write [[walls]]",
    "fluid.bodies.water.rectangle=[1, 0, 0, 1]": "needs x0 < x1 and y0 < y1",
    "fluid.bodies.water.circle={ centre = [0, 0], radius = 1 }": "fluid.bodies[0]: give exactly one of",
    "solid.dx=0.08": "solid.dx = 0.08: larger than body 'plate', which measures 0.05 m across",
    "solid.dx=0.025": "2 particles across body 'plate'; model total-lagrangian needs 3",
    "solid.dx=1e-9": "the limit is",
    "solid.clamps=[]": "body 'plate' has no clamp",
    "solid.clamps.0.face=botom": "no such face; did you mean 'bottom'?",
    "solid.clamps=[{ body='plate', face='top' }, { body='plate', face='top' }]": "is held by solid.clamps[0] already",
    "solid.bodies.plate.rectangle=[0.497, 0, 0.6, 0.3]": "'plate' overlaps fluid.bodies[0], 'water', near",
    "walls.tank.name=water": "already the name of fluid.bodies[0]",
    "walls.tank.polyline=[[1, 1], [1, 0], [0, 0], [0, 1]]": "walk the polyline with the fluid on its left",
    "coupling.window=2.0": "longer than end_time",
    "output.average_from=1.0": "not before end_time",
    "probes.tip.body=water": "a fluid, but displacement-x is of a solid body",
    "probes.tip.quantity=pressure": "pressure is not of a body",
    "goal={ probe = 'tap' }": "did you mean 'tip'?",
    "references=[{ probe = 'tip', name = 'x', curve = 'none.csv' }]": "no such file",
    "references=[{ probe = 'tip', name = 'x' }]": "give either value or curve",
    "solid.bodies.plane.free=true": "no item named 'plane'; did you mean 'plate'?",
    "solid.bodies=[{ name='plate', difference=[{ rectangle=[0.6, 0, 0.65, 0.3] }, { rectangle=[0, 0, 1, 1] }] }]": (
        "solid.bodies[0]: 'plate' is empty: the shapes that are taken away leave nothing"
    ),
    "end_time": "write path.to.key=value",
    "end_time.x=1": "end_time is a value, not a table",
    "fluid..dx=0.02": "--set fluid..dx=0.02: write path.to.key=value",
    "fluid.dx=1\nb=2": 'fluid.dx = "1\\nb=2": must be a number > 0 [m]',
    "fluid.dx=" + 5000 * "1": 'fluid.dx = "111',
    "fluid.dx=" + 3000 * "[": 'fluid.dx = "[[[',
    "fluid.sound_speed=1e-300": "fluid.sound_speed = 1e-300: must be 0 or at least 1e-35 in size",
    "gravity=[0, -1e308]": "gravity = [0, -1e+308]: must be at most 1e+35 in size",
}


@pytest.mark.parametrize("change", WRONG)
def test_one_mistake_is_one_line_that_says_it(scene_file, change):
    moved = change.startswith(("solid.bodies.plate.rectangle", "solid.bodies=["))
    text = GOOD.split("[[probes]]")[0] if moved else GOOD
    (line,) = mistakes(scene_file(text), change)
    assert WRONG[change] in line


@pytest.mark.parametrize("text", ["fluid.dx = " + 5000 * "1", 3000 * "[", "x = " + 3000 * "["])
def test_a_file_that_cannot_be_read_as_toml(tmp_path, text):
    (tmp_path / "odd.toml").write_text(text)
    with pytest.raises(BadInput, match="not TOML"):
        load_scene(tmp_path / "odd.toml")


def test_limits_of_the_ledger_may_be_without_measure(scene_file):
    assert load_scene(scene_file(), ["coupling.limits.energy=1e300"]).coupling.limits.energy == 1e300


MOTION = "solid.motion={ times = [0, 1], translation = [[0, 0], [0, 0.1]] }"
TOUCHING = ("solid.bodies.plate.rectangle=[0.5, 0, 0.55, 0.3]", "probes.tip.point=[0.5, 0.3]")
NO_SPEED = ("gravity=[0, 0]",)


@pytest.mark.parametrize(
    ("sets", "told"),
    [
        (NO_SPEED, False),
        ((*NO_SPEED, "fluid.model=ctvf"), False),
        ((*NO_SPEED, "solid.model=rigid", "solid.clamps=[]", MOTION), True),
        ((*NO_SPEED, "fluid.sound_speed=10.0"), True),
        ((*NO_SPEED, "fluid.model=still", *TOUCHING), True),
        ((*NO_SPEED, "fluid.bodies.water.velocity=[0.1, 0]"), True),
        ((*NO_SPEED, "walls.tank.motion={ times = [0, 1], translation = [[0, 0], [0, 0.1]] }"), True),
        ((*NO_SPEED, "walls.tank.motion={ times = [0, 1], translation = [[0, 0], [0, 0]] }"), False),
    ],
)
def test_the_automatic_sound_speed_needs_something_that_tells_it(scene_file, sets, told):
    if told:
        assert load_scene(scene_file(), sets).gravity == (0.0, 0.0)
    else:
        (line,) = mistakes(scene_file(), *sets)
        assert 'fluid.sound_speed = "auto": needs an expected speed' in line


def test_touching_is_no_overlap(scene_file):
    assert load_scene(scene_file(), TOUCHING).solid.bodies[0].rectangle[0] == 0.5


def test_bodies_that_cover_each_other_are_found_both_ways(scene_file):
    around = 'solid.bodies.plate = { name = "plate", rectangle = [-1.0, -1.0, 2.0, 2.0] }'
    assert any("overlaps" in line for line in mistakes(scene_file(), around))


def test_empty_scene_has_no_side(scene_file):
    assert any("both missing" in line for line in mistakes(scene_file('schema = 1\ntitle = "x"\nend_time = 1.0')))


def test_not_toml_names_the_line(scene_file):
    with pytest.raises(BadInput, match="line 3"):
        load_scene(scene_file("schema = 1\n\ntitle = \n"))


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    path = tmp_path / "marked.toml"
    path.write_text(GOOD, encoding="utf-8-sig")
    assert load_scene(path).end_time == 1.0


def test_a_directory_names_the_scenes_in_it(tmp_path):
    (tmp_path / "one.toml").write_text(GOOD)
    with pytest.raises(BadInput, match=r"a directory; name a scene's file \(in it: one.toml\)"):
        load_scene(tmp_path)


def test_a_pipe_and_nothing_are_no_scenes(tmp_path):
    """They were told of as no file, and as a directory."""
    os.mkfifo(tmp_path / "pipe")
    for case, what in ((tmp_path / "pipe", "pipe: a pipe or a device; write the scene to a file"), ("", "no scene is")):
        with pytest.raises(BadInput, match=what):
            load_scene(case)


def test_missing_file_lists_cases_and_suggests():
    with pytest.raises(BadInput, match=r"did you mean 'dam_break_plate'.*\n.*still_tank"):
        load_scene("dam_break_plat")


def test_sets_make_tables_and_reach_items_by_name_and_number(scene_file):
    sets = ["coupling.window=1e-4", "probes.tip.point.0=0.61", "solid.bodies[0].rotate.angle=0", 'title="a = b"']
    scene = load_scene(scene_file(), sets)
    assert scene.coupling.window == 1e-4
    assert scene.probes[0].point == (0.61, 0.3)
    assert scene.solid.bodies[0].rotate.angle == 0.0
    assert scene.title == "a = b"
    assert load_scene(scene_file(), ["title=bare words"]).title == "bare words"


WARNED = {
    "solid.dx=0.0165": ["particles across"],
    "solid.bodies.plate.rectangle=[0.6, 0, 0.644, 0.3]": ["apart"],
    "fluid.dx=0.05": ["differ 5 times"],
    "walls.tank.slip=no": ["no effect with fluid.viscosity"],
    "fluid.alpha=0.0": ["without any viscosity"],
    "fluid.sound_speed=10.0": ["water is expected to reach"],
}


@pytest.mark.parametrize("change", WARNED)
def test_warnings(scene_file, change):
    warnings = "\n".join(scene_warnings(load_scene(scene_file(), [change, "probes=[]"])))
    assert all(part in warnings for part in WARNED[change])


def test_curves_are_read_in_order_of_time(tmp_path):
    path = tmp_path / "curve.csv"
    path.write_text("time,value\n# comment\n2.0, 4.0\n1.0, 3.0\n")
    assert read_curve(path, (0.5, 10.0)).tolist() == [[0.5, 30.0], [1.0, 40.0]]
    path.write_text("1.0,2.0\n1.0;2.0\n")
    with pytest.raises(ValueError, match="line 2"):
        read_curve(path)


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_scene_comes_back_from_its_dump(tmp_path, name):
    scene = load_scene(name)
    path = tmp_path / "case.toml"
    path.write_text(dump_scene(scene), encoding="utf-8")
    assert load_scene(path) == scene
    assert tomllib.loads(path.read_text())["coupling"]["scheme"] == scene.coupling.scheme


numbers = st.floats(-1e34, 1e34)
positive = st.floats(min_value=1e-12, max_value=1e12)
pairs = st.tuples(numbers, numbers)
names = st.from_regex(r"[A-Za-z][A-Za-z0-9_-]{0,8}", fullmatch=True)
text = st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=20)
leaf = st.one_of(
    st.tuples(numbers, numbers, positive, positive)
    .filter(lambda r: r[0] < r[0] + r[2] and r[1] < r[1] + r[3])
    .map(lambda r: {"rectangle": [r[0], r[1], r[0] + r[2], r[1] + r[3]]}),
    st.builds(lambda c, r: {"circle": {"centre": c, "radius": r}}, pairs, positive),
    st.lists(pairs, min_size=3, max_size=5, unique=True).map(lambda p: {"polygon": p}),
)
shapes = st.recursive(
    leaf,
    lambda s: st.lists(s, min_size=2, max_size=3).flatmap(lambda x: st.sampled_from([{"union": x}, {"difference": x}])),
)
sets = st.lists(text, max_size=2)
families = st.builds(lambda n, s, v: {"name": n, "sets": s, "vary": v}, text, sets, st.lists(st.lists(sets)))
studies = st.builds(lambda s, f: {"sets": s, "families": f}, sets, st.lists(families, min_size=1, max_size=3))


@settings(max_examples=60, deadline=None)
@given(
    title=text,
    gravity=pairs,
    bodies=st.lists(st.tuples(names, shapes), min_size=1, max_size=3),
    dx=positive,
    study=studies,
)
def test_any_scene_survives_the_file(title, gravity, bodies, dx, study):
    data = {
        "schema": 1,
        "title": title,
        "end_time": dx,
        "gravity": gravity,
        "fluid": {"model": "ctvf", "dx": dx, "bodies": [{"name": n, **s} for n, s in bodies]},
        "walls": [{"name": n, "polyline": [(0, 0), gravity], "closed": True} for n, _ in bodies if any(gravity)],
        "probes": [{"name": n, "quantity": "leaked"} for n, _ in bodies],
        "study": study,
    }
    scene = Scene.model_validate(data)
    again = Scene.model_validate_json(json.dumps(tomllib.loads(dump_scene(scene))), strict=True)
    assert again == scene


def test_a_scene_in_a_folder_whose_name_is_not_utf_8_finds_its_curves(tmp_path):
    """The curve's absolute path was told of as a mistake of the whole scene."""
    folder = tmp_path / os.fsdecode(b"caf\xe9")
    folder.mkdir()
    (folder / "own.csv").write_text("time,x\n0.0,0.0\n2.0,1e-3\n")
    (folder / "p.toml").write_text(dump_scene(load_scene("piston")), encoding="utf-8")
    scene = load_scene(folder / "p.toml", ["references[0].curve=own.csv"])
    assert scene.references[0].curve == str((folder / "own.csv").resolve())
    assert 'curve = "own.csv"' in dump_scene(scene, folder)
