"""The variants of a case's study: every combination of the settings of each family's axes."""

from __future__ import annotations

import hashlib
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass

from shared.contract import BadInput
from shared.scene.reading import computed, load_scene
from shared.schema.scene import Scene

_SPACING = re.compile(r"^(fluid|solid)\.dx\s*=")
_HASH_DIGITS = 8
_LONGEST_NAME = 100  # of a family, in its runs' folders


@dataclass(frozen=True)
class Variant:
    """One run of a chart: `sets` turn the case into `scene`; `label` says where it differs from its family's others;
    `series`: variants of one family that differ in spacing only; `folder`: name of its run directory."""

    family: str
    label: str
    series: str
    sets: tuple[str, ...]
    scene: Scene
    folder: str

    @property
    def settings(self) -> str:
        """The label, in words where it is empty."""
        return self.label or "as it stands"

    @property
    def dx(self) -> float:
        """The spacing [m] that the error is plotted against: the finer of both sides."""
        return min(side.dx for side in (self.scene.fluid, self.scene.solid) if side is not None)


def study_variants(case: str, sets: Sequence[str] = ()) -> list[Variant]:
    """All variants of a case's study, each checked as a scene. Raises BadInput with every mistake."""
    scene = load_scene(case, sets)
    if scene.study is None or scene.goal is None:
        missing = "[study]" if scene.study is None else "[goal]"
        raise BadInput(f"{case}: a chart needs the table {missing}; cases/SCENE.md documents it")
    found, mistakes = [], []
    for i, family in enumerate(scene.study.families):
        mistakes += [
            f"study.families[{i}].vary[{k}]: an axis without settings, so that the family has no variants: give it "
            "some, or leave it away"
            for k, axis in enumerate(family.vary)
            if not axis
        ]
        for settings in itertools.product(*family.vary):
            own = tuple(itertools.chain.from_iterable(settings))
            changes = (*sets, *scene.study.sets, *family.sets, *own)
            try:
                found.append(_variant(case, family.name, own, changes))
            except BadInput as error:
                mistakes.append(f"variant {family.name!r} {' '.join(own)}: {error}")
    if mistakes:
        raise BadInput("\n".join(mistakes))
    return found


def _variant(case: str, family: str, own: tuple[str, ...], changes: tuple[str, ...]) -> Variant:
    scene = load_scene(case, changes)
    digest = hashlib.sha256(computed(scene).encode()).hexdigest()[:_HASH_DIGITS]
    others = " ".join(text for text in own if not _SPACING.match(text))
    return Variant(
        family=family,
        label=" ".join(own),
        series=f"{family} {others}".strip(),
        sets=changes,
        scene=scene,
        folder=re.sub(r"[^A-Za-z0-9]+", "-", family).strip("-")[:_LONGEST_NAME] + "-" + digest,
    )
