"""The key-by-key part of `cases/maps/README.md`, made from the vocabulary of a stability map.

`python -m coupler.stability.reference` rewrites it; what stands above the marker line is written by hand and kept.
"""

from __future__ import annotations

from pathlib import Path

from coupler.stability.map import StabilityMap, maps_folder
from shared.scene.reference import render

MARKER = "<!-- Below: made from the vocabulary by `python -m coupler.stability.reference` -->"


def reference_file() -> Path:
    """The file that holds the reference."""
    return maps_folder() / "README.md"


def renewed(text: str) -> str:
    """`text` of the file with everything below the marker renewed."""
    return render(text, MARKER, StabilityMap)


if __name__ == "__main__":
    path = reference_file()
    path.write_text(renewed(path.read_text(encoding="utf-8")), encoding="utf-8")
