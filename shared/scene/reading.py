"""Reading and writing scenes: one TOML file in, one checked `Scene` out, or every mistake at once."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from shared.contract import BadInput
from shared.scene.checks import check_scene
from shared.scene.errors import validate
from shared.scene.fields import closest
from shared.scene.sets import apply_sets
from shared.schema.scene import Scene

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def load_scene(case: str | Path, sets: Sequence[str] = ()) -> Scene:
    """The scene of a TOML file or a shipped case, changed by `sets` ("path.to.key=value") and checked.

    Curves of references come out as absolute paths. Raises BadInput with all mistakes, one per line.
    """
    path = _find(case)
    data = read_toml(path)
    mistakes = apply_sets(data, sets)
    scene, breaches = validate(data)
    scene = _with_curves(scene, path.parent)
    mistakes += breaches
    mistakes += check_scene(scene, readable=not mistakes)
    if mistakes:
        count = "1 mistake" if len(mistakes) == 1 else f"{len(mistakes)} mistakes"
        raise BadInput(f"{path}: {count}\n" + "\n".join(f"  {mistake}" for mistake in mistakes))
    return scene


def dump_scene(scene: Scene, folder: Path | None = None) -> str:
    """The scene as TOML with all defaults written out; it loads back to an equal scene. Curves in `folder`, in which
    the text is to stand, are named from there."""
    data = scene.model_dump(by_alias=True, exclude_none=True, mode="json")
    for reference in data["references"] if folder is not None else ():
        if "curve" in reference and (curve := Path(reference["curve"])).is_relative_to(folder.resolve()):
            reference["curve"] = str(curve.relative_to(folder.resolve()))
    plain = {key: value for key, value in data.items() if not _is_tables(value)}
    lines = [f"{key} = {_value(value)}" for key, value in plain.items()]
    for key, value in data.items():
        if key in plain:
            continue
        for table in value if isinstance(value, list) else [value]:
            lines += ["", f"[[{key}]]" if isinstance(value, list) else f"[{key}]"]
            lines += [f"{_key(k)} = {_value(v, broken=_is_tables(v))}" for k, v in table.items()]
    return "\n".join(lines) + "\n"


def computed(scene: Scene) -> str:
    """All of the scene that a run's probes depend on, as TOML: not its study, nor what they are compared with."""
    return dump_scene(scene.model_copy(update={"study": None, "references": []}))


def shipped_cases() -> dict[str, Path]:
    """Name and file of the cases that ship."""
    return {path.stem: path for path in sorted(_cases_folder().glob("*.toml"))}


def _cases_folder() -> Path:
    return Path(str(files("cases")))


def _find(case: str | Path) -> Path:
    path = Path(case)
    if not str(case):
        raise BadInput("no scene is named: a file, or a shipped case (`coupler cases` lists them)")
    if path.is_file():
        return path.resolve()
    if path.is_dir():
        inside = [one.name for one in sorted(path.glob("*.toml"))]
        found = f"in it: {', '.join(inside)}" if inside else "there is no TOML file in it"
        raise BadInput(f"{case}: a directory; name a scene's file ({found})")
    if path.exists():
        raise BadInput(f"{case}: a pipe or a device; write the scene to a file, which its run keeps and may read again")
    shipped = shipped_cases()
    if str(case) in shipped:
        return shipped[str(case)]
    close = closest(path.stem, shipped)
    hint = f"; did you mean '{close}'?" if close else ""
    raise BadInput(f"{case}: no such file or shipped case{hint}\n  shipped cases: {', '.join(shipped)}")


def read_toml(path: Path) -> dict[str, Any]:
    """What a TOML file holds. Raises BadInput."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path}: cannot be read: {error}") from None
    except (ValueError, RecursionError) as error:  # not TOML, a number of thousands of digits, thousands of brackets
        raise BadInput(f"{path}: not TOML: {error}") from None


def _with_curves(scene: Scene, folder: Path) -> Scene:
    """The scene with absolute paths of its references' curves: relative to its `folder`, or else to the shipped cases.
    A folder's name need not be text, as all in a scene's file is."""
    references = []
    for reference in scene.references:
        if reference.curve is not None:
            places = (folder / reference.curve, _cases_folder() / reference.curve)
            curve = next((str(place.resolve()) for place in places if place.is_file()), reference.curve)
            reference = reference.model_copy(update={"curve": curve})
        references.append(reference)
    return scene.model_copy(update={"references": references})


def _is_tables(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _value(key)


def _value(value: Any, broken: bool = False) -> str:
    """A TOML value; with `broken`, a list's items stand on lines of their own."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }" if value else "{}"
    if isinstance(value, list):
        if broken:
            return "[\n" + "".join(f"    {_value(item)},\n" for item in value) + "]"
        return "[" + ", ".join(_value(item) for item in value) + "]"
    # JSON text is TOML text, except that TOML wants the delete character escaped.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
