"""Where and when a model disagrees is told of the right axis, time and condition."""

from dataclasses import replace

from lta_analysis.discovery.fit.evidence import tolerances
from lta_analysis.discovery.fit.fit import fit
from lta_analysis.discovery.flights.measured import Stream
from lta_analysis.discovery.model.knobs import Knob
from lta_analysis.discovery.model.nominal import Nominal
from lta_analysis.discovery.replay.linear import origin
from lta_analysis.discovery.replay.linearise import Linearised
from lta_analysis.discovery.replay.replay import Replay
from lta_analysis.discovery.where.places import places, Seen
from lta_sim.vehicle import load_vehicle
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[Nominal, list[Knob]]
FAILED = 24.0  # s


@pytest.fixture(scope='module')
def failing(gtmab: Known) -> Linearised:
    """A flight in which a forward rotor begins to do less than it is told."""
    whole = prepared(flown({}, 1, 48.0), gtmab[1])
    flight = whole.replay.flight
    told = flight.commands.values.copy()
    told[flight.commands.time > FAILED, 2] *= 2.0  # as if it had been told more all along
    told = np.minimum(told, 1.0)
    flight = replace(flight, commands=Stream(flight.commands.time, told))
    replay = Replay(flight, whole.replay.cut, load_vehicle('gtmab').command(()))
    return Linearised(replay, gtmab[1], whole.places)


def _seen(known: Known, flight: Linearised) -> Seen:
    nominal, knobs = known
    begin = origin(nominal, knobs, len(flight.replay.first))
    return Seen('one', flight, begin, fit(flight, nominal, tolerances(knobs), begin, rounds=3))


@pytest.mark.long
def test_a_rotor_that_fails_is_told_with_its_time(gtmab: Known, failing: Linearised) -> None:
    found = places([_seen(gtmab, failing)], 1)
    assert [one.ratio_to_noise for one in found] == sorted(
        (one.ratio_to_noise for one in found), reverse=True
    )
    (change,) = [one for one in found if one.condition.startswith('after')]
    assert change.condition.endswith('as if rotor_fault.lost_3 changed')
    assert change.from_s == pytest.approx(FAILED, abs=6.0)  # to a piece
    assert change.channel in {'surge', 'yaw', 'pitch'}
    assert 'x' in {one.channel for one in found}


def test_a_clean_flight_disagrees_hardly_anywhere(gtmab: Known, clean: Linearised) -> None:
    """What is told begins at twice the noise; of 30 s and 14 channels one may just reach it."""
    found = places([_seen(gtmab, clean)], 1)
    assert len(found) <= 1
    assert all(one.ratio_to_noise < 2.5 for one in found)


def test_without_a_fit_the_channels_alone_are_told(gtmab: Known, failing: Linearised) -> None:
    begin = origin(*gtmab, len(failing.replay.first))
    found = {place.channel for place in places([Seen('one', failing, begin)], 1)}
    assert 'x' in found
    assert not {'surge', 'yaw'} & found
