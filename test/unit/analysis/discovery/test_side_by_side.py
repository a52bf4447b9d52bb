"""Work side by side gives what it gives one after the other."""

from threading import Barrier

from lta_analysis.discovery.evidence import tolerances
from lta_analysis.discovery.fit import fit
from lta_analysis.discovery.knobs import Knob
from lta_analysis.discovery.linear import Linear, origin
from lta_analysis.discovery.linearise import Linearised
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.side_by_side import cores, side_by_side
import numpy as np
import pytest


def test_answers_keep_the_order_and_work_overlaps() -> None:
    together = Barrier(2)

    def work(item: int) -> int:
        together.wait(60.0)  # passes only if two are under way at once
        return item**2

    assert side_by_side(work, range(6), workers=2) == [0, 1, 4, 9, 16, 25]
    assert side_by_side(str, [], workers=2) == []
    assert cores() >= 1


def test_the_first_failure_in_order_is_raised() -> None:
    def work(item: int) -> int:
        if item in (3, 5):
            raise ValueError(item)
        return item

    for workers in (1, 2, 4):
        with pytest.raises(ValueError, match=r'^3$'):
            side_by_side(work, range(8), workers)


def test_a_fit_is_the_same_to_the_bit_with_any_number_of_workers(
    gtmab: tuple[Nominal, list[Knob]], clean: Linearised
) -> None:
    nominal, knobs = gtmab
    begin = origin(nominal, knobs, len(clean.replay.first))

    def work(name: str) -> Linear:
        return fit(clean, nominal, tolerances(knobs, (name,)), begin, rounds=2).linear

    names = ('linear_drag.surge', 'cg_offset.x')
    alone, together = (side_by_side(work, names, workers) for workers in (1, 2))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.grams, other.grams)
        np.testing.assert_array_equal(one.point.values, other.point.values)
