"""What the info of a participant's reply must carry, by verb (shared/wire.py); checked before anything uses it."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from typing import Any

from shared.contract import BadInput, ParticipantLost, SolverFailed
from shared.schema.solid import PARTICLE_MODELS
from shared.wire import BadMessage

ROLES = {"fluid": "fluid", "solid": "structure"}
"""Role that the participant of each name has to have."""
_TEXTS = ("name", "role", "model")
_LENGTHS = ("stable_step", "spacing")
_NUMBERS = {"fluid": ("density", "support"), "solid": ("density", "thickness")}
_EXIT_CODES = (BadInput.exit_code, SolverFailed.exit_code, ParticipantLost.exit_code)


def check_info(sender: str, verb: str, info: Mapping[str, Any]) -> None:
    """Refuse the info of `sender`'s reply to `verb` where what is needed is missing or of another kind."""
    if verb == "describe":
        _check_description(sender, info)
    elif verb == "start" or (verb in ("advance", "accept") and "probes" in info):
        _check_map("probes", info.get("probes"))
    elif verb == "finish":
        _check_cost(info.get("cost"))
    elif verb == "error":
        text, code = info.get("text"), info.get("exit_code", SolverFailed.exit_code)
        _need(isinstance(text, str) and text.strip() != "", "text of its error", text, "what is wrong")
        _need(_is_number(code) and code in _EXIT_CODES, f"exit_code of its error ({text})", code, "2, 3 or 4")


def _check_description(sender: str, info: Mapping[str, Any]) -> None:
    for key in _TEXTS:
        _need(isinstance(info.get(key), str), key, info.get(key), "text")
    _need(info["role"] == ROLES[sender], "role", info["role"], repr(ROLES[sender]))
    for key in _LENGTHS:
        _need_positive(key, info.get(key))
    numbers = info.get("numbers")
    _check_map("numbers", numbers)
    needed = list(_NUMBERS[sender])
    needed += ["sound_speed"] if sender == "fluid" and "sound_speed" in numbers else []
    needed += ["wave_speed"] if sender == "solid" and info["model"] in PARTICLE_MODELS else []
    for key in needed:
        _need_positive(f"numbers.{key}", numbers.get(key))
    if unknown := info.keys() - {*_TEXTS, *_LENGTHS, "numbers"}:
        raise BadMessage(f"info has unknown keys {sorted(map(str, unknown))}")


def _check_cost(cost: Any) -> None:
    _need(isinstance(cost, Mapping), "cost", cost, "a map of what the side has cost")
    _check_map("cost", {key: value for key, value in cost.items() if key not in ("model", "lost_near")})
    _need("core_s" in cost and 0.0 <= cost["core_s"] < math.inf, "cost.core_s", cost.get("core_s"), "a time [s]")
    _need(isinstance(cost.get("model", ""), str), "cost.model", cost.get("model"), "text")
    if cost.get("lost") or "lost_near" in cost:
        near = cost.get("lost_near")
        two = isinstance(near, list) and len(near) == 2 and all(map(_is_number, near))
        _need(two, "cost.lost_near", near, "a place (x, y) [m]")
        _need("lost_fraction" in cost, "cost.lost_fraction", None, "a number")


def _check_map(key: str, value: Any) -> None:
    """A map from names to numbers; those without a value are nan."""
    _need(isinstance(value, Mapping), key, value, "a map from names to numbers")
    for name, number in value.items():
        _need(isinstance(name, str), f"name in {key}", name, "text")
        _need(_is_number(number), f"{key}.{name}", number, "a number")


def _need_positive(key: str, value: Any) -> None:
    _need(_is_number(value) and 0.0 < value < math.inf, key, value, "a number above 0")


def _need(holds: bool, key: str, value: Any, needed: str) -> None:
    if not holds:
        raise BadMessage(f"{key} is {'missing' if value is None else reprlib.repr(value)}; {needed} is needed")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
