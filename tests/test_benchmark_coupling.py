"""The coupled benchmark: its rows can be run and come after what they refer to; the envelope judges histories."""

from __future__ import annotations

import numpy as np
import pytest

from shared.scene.reading import load_scene
from tests.benchmark_coupling import ENVELOPE, beyond_envelope
from tests.benchmark_coupling_rows import rows


def test_rows_are_scenes_with_their_probes_in_an_order_that_can_be_run():
    before = set()
    for row in rows():
        probes = {probe.name for probe in load_scene(row.case, row.sets).probes}
        assert not row.probe or row.probe in probes
        assert not isinstance(row.truth, str) or row.truth in before
        assert isinstance(row.truth, (float, str, type(None)))
        assert row.demand not in before
        before.add(row.demand)


def test_distance_from_the_envelope_is_after_the_best_shift_of_ten_milliseconds_at_most():
    time, middle = ENVELOPE[:, 0], ENVELOPE[:, 1:].mean(axis=1)
    assert beyond_envelope(time, middle) == (0.0, 0.0)
    late, shift = beyond_envelope(time + 0.008, middle)
    assert late == pytest.approx(0.0, abs=1e-4)
    assert shift == pytest.approx(-0.008, abs=0.008)
    higher, _ = beyond_envelope(time, np.full(len(time), 0.06))
    assert higher == pytest.approx((0.06 - ENVELOPE[:, 2]).max(), abs=1e-6)
