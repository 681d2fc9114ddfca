"""Imports go one way: solvers and coupler import shared, never each other; physics never sees zenoh.
Participants that ship as examples import nothing of this project. Pre-flight measures, then bounds, then judges.

The rules are read from the sources, so that an import inside a function counts as well. Each rule is also tried on
sources that break it.
"""

import ast
import itertools
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

PACKAGES = ("shared", "fluid_solver", "solid_solver", "coupler", "cases")
MAY_IMPORT = {
    "shared": {"shared"},
    "fluid_solver": {"fluid_solver", "shared", "cases"},
    "solid_solver": {"solid_solver", "shared", "cases"},
    "coupler": {"coupler", "shared", "cases"},
    "cases": {"cases", "shared"},
}
# The in-process link, for tests and --link inprocess, makes the models that the processes would make.
MAY_IMPORT_BY_NAME = {"coupler.inprocess"}
# Pre-flight: what a scene's numbers are, how far off its run may be, what to say of it; each knows those before it.
PREFLIGHT = [f"coupler.preflight.{part}" for part in ("measures", "bounds", "rules")]
# What starts a solver as a process; everything else in a solver is physics.
NOT_PHYSICS = {"cli", "__main__"}


def modules(root: Path) -> dict[str, str]:
    """Source of every module of the packages under `root`, by dotted name."""
    found = {}
    for package in PACKAGES:
        for path in (root / package).rglob("*.py"):
            parts = path.relative_to(root).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path.read_text()
    return found


def imports(name: str, source: str) -> set[str]:
    """Dotted names that a module imports anywhere, `?` for one chosen at run time."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = name.split(".")[: -node.level] if node.level else []
            base += [node.module] if node.module else []
            found |= {".".join([*base, *more]) for more in ([], *([alias.name] for alias in node.names))} - {""}
        elif isinstance(node, ast.Call):
            function = ast.unparse(node.func)
            if function.split(".")[-1] in ("import_module", "__import__") and node.args:
                argument = node.args[0]
                found.add(argument.value if isinstance(argument, ast.Constant) else "?")
    return found


def breaches(sources: dict[str, str]) -> list[str]:
    """Every import that a rule forbids, as `module imports what`."""
    found = []
    for name, source in sources.items():
        package = name.split(".")[0]
        for imported in sorted(imports(name, source)):
            top = imported.split(".")[0]
            allowed = top not in PACKAGES or (top in MAY_IMPORT[package] and not name.startswith("cases.participant"))
            if top == "zenoh":
                allowed = name.startswith(("shared.link", "cases.participant"))
            if top == "?":
                allowed = name in MAY_IMPORT_BY_NAME
            for before, after in itertools.combinations(PREFLIGHT, 2):
                allowed &= not (name.startswith(before) and imported.startswith(after))
            if not allowed:
                found.append(f"{name} imports {imported}")
    return found


def reached(sources: dict[str, str], start: str) -> set[str]:
    """All that is imported on the way from module `start`, within and outside the packages."""
    seen, waiting = set(), [start]
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            waiting += imports(name, sources[name]) if name in sources else []
    return seen


def physics(sources: dict[str, str]) -> list[str]:
    """The solvers' modules that compute."""
    solvers = ("fluid_solver.", "solid_solver.")
    return [n for n in sources if n.startswith(solvers) and n.split(".")[-1] not in NOT_PHYSICS]


@pytest.fixture(scope="module")
def sources():
    return modules(Path(find_spec("shared").origin).parent.parent)


def test_imports_go_one_way(sources):
    assert {name.split(".")[0] for name in sources} == set(PACKAGES)
    assert breaches(sources) == []


def test_physics_never_reaches_zenoh(sources):
    found = physics(sources)
    assert {"fluid_solver.models", "solid_solver.models"} <= set(found)
    for name in found:
        assert "zenoh" not in {imported.split(".")[0] for imported in reached(sources, name)}, name


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("shared.grid", "import fluid_solver"),
        ("shared.grid", "from solid_solver.models import make_model"),
        ("shared.grid", "import cases"),
        ("shared.grid", "def late():\n    from coupler import schemes"),
        ("fluid_solver.walls", "import solid_solver.clamps"),
        ("fluid_solver.walls", "if True:\n    import coupler.mapping as mapping"),
        ("solid_solver.clamps", "from fluid_solver import walls"),
        ("solid_solver.clamps", "from .. import coupler"),
        ("coupler.schemes", "from fluid_solver.models import make_model"),
        ("coupler.schemes", "import importlib\nimportlib.import_module('solid_solver.models')"),
        ("coupler.schemes", "from importlib import import_module\nimport_module(side + '_solver')"),
        ("coupler.schemes", "__import__('fluid_solver')"),
        ("coupler.preflight.measures.water", "from coupler.preflight.rules import joint"),
        ("coupler.preflight.bounds.flow", "from coupler.preflight.rules.water import mach"),
        ("coupler.supervisor", "import zenoh"),
        ("shared.participant", "from zenoh import Config"),
        ("cases.participant.spring", "from shared.wire import encode"),
        ("fluid_solver.walls", "try:\n    import zenoh\nexcept ImportError:\n    pass"),
    ],
)
def test_each_rule_is_enforced(name, source):
    assert len(breaches({name: source})) >= 1


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("shared.link_zenoh", "import zenoh"),
        ("shared.scene.reading", "from importlib.resources import files\nfiles('cases')"),
        ("coupler.supervisor", "command = ['python', '-m', 'fluid_solver']"),
        ("coupler.inprocess", "import importlib\nimportlib.import_module(name)"),
        ("fluid_solver.walls", "from fluid_solver.fields import X\nfrom shared import jit\nimport numpy"),
    ],
)
def test_what_is_allowed_passes(name, source):
    assert breaches({name: source}) == []


def test_zenoh_is_found_behind_other_modules():
    sources = {
        "fluid_solver.walls": "from shared import grid",
        "shared.grid": "def late():\n    import shared.link_zenoh",
        "shared.link_zenoh": "import zenoh",
    }
    assert "zenoh" in reached(sources, "fluid_solver.walls")


def test_what_draws_is_loaded_when_something_is_drawn():
    """Half a second of every start, and a solver that is coupled never draws."""
    code = "import sys, coupler.cli, fluid_solver.cli, solid_solver.cli; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=120).returncode == 0
