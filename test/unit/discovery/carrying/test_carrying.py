"""Names by forecasts: they carry over, values cover what is hidden, and nothing is nothing."""

from dataclasses import replace

from lta_discovery.carrying.choose import choose
from lta_discovery.carrying.confirm import confirmed
from lta_discovery.carrying.groups import Group, groups
from lta_discovery.carrying.intervals import drawn, intervals
from lta_discovery.carrying.online import online
from lta_discovery.carrying.pieces import APART, far
from lta_discovery.carrying.values import valued
from lta_discovery.finding import Carried, Finding, Gap, LeftOut, NamedEffect, Worth
from lta_discovery.flights.measured import PERIOD
from lta_discovery.flights.splitting import part
from lta_discovery.forecast.ahead import Ahead, HORIZONS
from lta_discovery.forecast.foresight import Foresight
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.page.carried import carried
from lta_discovery.replay.linearise import Linearised
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.results.terminal import carried_words
import numpy as np
import pytest

Known = tuple[Nominal, list[Knob]]
OFF = 0.6  # of the drag that a model lacks
SIDES = {'first': [0], 'second': [1]}
NAMED = ('quadratic drag', 'added mass', 'cg offset', 'tracker misalignment')


def halves(flight: Linearised, knobs: list[Knob]) -> list[Linearised]:
    """Return the two halves of a flight in pieces that are predicted."""
    out = []
    for begin, end in ((0.0, 0.5), (0.5, 1.0)):
        cut = replace(flight.replay.cut)
        half = Linearised(flight.replay.in_pieces(cut), knobs, flight.places)
        half.replay.flight = part(flight.replay.flight, begin, end)
        found = far(half, knobs)
        assert found is not None
        out.append(found)
    return out


def some(knobs: list[Knob]) -> list[Group]:
    """Return a few candidates, so that the test is quick."""
    return [group for group in groups(knobs) if group.name in NAMED]


@pytest.fixture(scope='module')
def lacking(gtmab: Known, clean: Linearised) -> tuple[Foresight, float]:
    """A model with too little drag on every axis, and by how much ahead."""
    wrong, known = gtmab
    off = OFF * wrong.value('quadratic_drag', 'surge')
    for axis in ('surge', 'sway', 'heave'):
        knob = next(one for one in known if one.name == f'quadratic_drag.{axis}')
        wrong = knob.turned(wrong, -OFF * wrong.value('quadratic_drag', axis))
    return Foresight(wrong, halves(clean, known), 0.0006), off


def test_pieces_overlap_and_are_whole(gtmab: Known, clean: Linearised) -> None:
    found = far(clean, gtmab[1])
    assert found is not None
    assert np.diff(found.replay.cut.first)[0] == round(APART / PERIOD)
    last = found.replay.cut.first[-1] + round(HORIZONS[-1] / PERIOD)
    assert found.replay.flight.usable[last - 1]
    assert found.replay.cut.inside.all()


def test_every_direction_of_an_effect_has_one_name(gtmab: Known) -> None:
    _, known = gtmab
    found = {group.name: group for group in groups(known)}
    names = [known[k].name for k in found['added inertia'].knobs]
    assert names == ['added_inertia.roll', 'added_inertia.pitch', 'added_inertia.yaw']
    every = [k for group in found.values() for k in group.knobs]
    assert len(every) == len(set(every))
    assert not any(known[k].per_flight for k in every)


def test_what_is_lacking_is_named_and_its_value_covered(lacking: tuple[Foresight, float]) -> None:
    sight, off = lacking
    found = choose(sight, [0, 1], SIDES, some(sight.knobs))
    assert found.names[0] == 'quadratic drag'
    kept = confirmed(sight, found, [[0], [1]])
    assert kept[0].name == 'quadratic drag'
    best = valued(sight, kept[:1], SIDES, 1)
    surge = next(k for k, knob in enumerate(sight.knobs) if knob.name == 'quadratic_drag.surge')
    assert best.fitted.values[surge] == pytest.approx(off, rel=0.2)
    assert all(one.ratio < 0.8 for one in best.regimes)


def test_nothing_carries_over_where_nothing_is_missing(gtmab: Known, clean: Linearised) -> None:
    nominal, known = gtmab
    sight = Foresight(nominal, halves(clean, known), 0.0006)
    assert choose(sight, [0, 1], SIDES, some(known)).names == ()


def test_flights_that_say_the_same_leave_no_doubt(lacking: tuple[Foresight, float]) -> None:
    """Drawn anew from one flight, over and over, values are those of that flight."""
    sight, off = lacking
    k = next(k for k, knob in enumerate(sight.knobs) if knob.name == 'quadratic_drag.surge')
    fitted = sight.fit([k], np.array([3.0 * off]), [0], rounds=2)
    ((low, high),) = intervals(drawn(fitted, sight.knobs, [k], np.array([3.0 * off]), 1))
    assert low == pytest.approx(fitted.values[k]) == high
    both = sight.fit([k], np.array([3.0 * off]), [0, 1], rounds=2)
    ((low, high),) = intervals(drawn(both, sight.knobs, [k], np.array([3.0 * off]), 1))
    assert low < both.values[k] < high


def test_a_lift_is_learned_from_what_is_over() -> None:
    """Errors that a constant lift makes vanish in the second piece, and stay in the first."""
    time = np.array([0.0, 10.0])
    column = np.zeros((2, len(HORIZONS), 6, 1))
    column[..., 2, 0] = np.square(HORIZONS)
    seen = Ahead(0.01 * column[..., 0], column)
    left = online(seen, time, lift=1.0)
    np.testing.assert_allclose(left[0], seen.left[0])
    assert np.abs(left[1]).max() < 1e-3 * np.abs(seen.left[1]).max()


CARRIED = Carried(
    (Worth('added inertia', 0.028),),
    (LeftOut('slow', 5, 0.95), LeftOut('fast', 4, 0.8)),
    ('side force',),
    72,
)
GAP = Gap('position', 'm', 5.0, 0.28, 0.27, 0.23, 0.31, 0.014, 0.18, (0.15, 0.22), 105, 0.17)


def told() -> Finding:
    """Return a finding by forecasts."""
    effect = NamedEffect('added_inertia', ('added_inertia.yaw',), (), 23.8)
    return Finding(
        'named+unexplained', (effect,), (), (), (GAP,), True, (), (), 1, {}, 'rgblimp',
        carried=CARRIED,
    )  # fmt: skip


def test_programs_and_people_are_told_what_names_rest_on() -> None:
    known = to_dict(told())
    assert known['carried']['regimes'][0] == {'name': 'slow', 'flights': 5, 'ratio': 0.95}
    assert known['carried']['interpolates'] == ['side force']
    assert known['gap']['refitted'] == 0.17
    assert '2 of 2 regimes' in carried_words(CARRIED)
    page = carried(told())
    assert '2.8 %' in page
    assert '\N{MINUS SIGN}5 %' in page  # of the worst regime
    assert '<b>side force</b>' in page
    assert '0.61' in page  # 0.17 of 0.28 m
    assert to_dict(replace(told(), carried=None))['carried'] is None
    assert carried(replace(told(), carried=None)) == ''
