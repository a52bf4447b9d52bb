"""What is said at the end follows from what was named and what is left."""

from lta_discovery.finding import ChannelErrors
from lta_discovery.fit.evidence import ParameterPosterior
from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.effect_search import EffectSearch
from lta_discovery.selection.effect_verification import VerifiedEffects
from lta_discovery.selection.interval import parameter_deviations
from lta_discovery.study import decide_study_verdict
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_discovery.unmodeled.oscillation import dominant_oscillations, LatentOscillation
from lta_discovery.unmodeled.rivals import GenericRival
from lta_discovery.unmodeled.spectral_line import SpectralLine
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_discovery.unmodeled.unmodeled_forces import UnmodeledForces
from lta_discovery.unmodeled.verdict import (
    add_oscillations,
    add_rival_terms,
    decide_verdict,
    describe_unexplained_forces,
    is_gusty,
    select_confirmed_rivals,
    select_evident_rivals,
)
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

PITCH = Remainder('pitch', 1.23e-3, 15.4, ('surge speed x yaw rate',), 0.6)
SURGE = Remainder('surge', 6.2e-3, 15.5, (), 0.03)
SWAY = Remainder('sway', 5.1e-3, 12.8, (), 0.05)
LAYERS = GenericRival(
    'heave by height', 40.0, 30.0, 34.0, 'heave', ('heave',), 3e-3, 'height', 0.7
)
LINE = SpectralLine('fz', 2.4, 0.031, 12.0)
SWING = LatentOscillation('force along y of the map', 0.21, 3.1e-3, 0.8)


@pytest.mark.parametrize(
    ('named', 'remains', 'rivals', 'lines', 'expected'),
    [
        ((), (), (), (), 'none'),
        (('motor_lag',), (), (), (), 'named'),
        ((), (PITCH,), (), (), 'unexplained'),
        ((), (), (LAYERS,), (), 'unexplained'),
        ((), (), (), (LINE,), 'unexplained'),
        ((), (), (), (SWING,), 'unexplained'),
        (('motor_lag',), (), (), (LINE,), 'named+unexplained'),
    ],
)
def test_the_verdict(
    named: tuple[str, ...],
    remains: tuple[Remainder, ...],
    rivals: tuple[GenericRival, ...],
    lines: tuple[SpectralLine | LatentOscillation, ...],
    expected: str,
) -> None:
    assert decide_verdict(named, remains, rivals, lines) == expected


def test_a_rival_counts_only_on_both_flights() -> None:
    assert select_confirmed_rivals([LAYERS]) == [LAYERS]
    assert select_confirmed_rivals([LAYERS._replace(carried=-2.0)]) == []
    assert select_confirmed_rivals([LAYERS._replace(gain=6.0, confirmed=5.0, carried=4.0)]) == []


def test_what_is_met_on_one_flight_only_tells_that_something_is_there() -> None:
    seldom = LAYERS._replace(gain=32.0, confirmed=-1.2, carried=-0.4)
    assert select_confirmed_rivals([seldom]) == []
    assert select_evident_rivals([LAYERS, seldom]) == [LAYERS, seldom]
    assert select_evident_rivals([LAYERS._replace(gain=-2.3, confirmed=23.9, carried=26.6)])
    assert (
        select_evident_rivals([seldom._replace(carried=-6.0)]) == []
    )  # the other flight contradicts it
    assert select_evident_rivals([seldom._replace(gain=15.0)]) == []
    assert decide_verdict((), (), (seldom,)) == 'unexplained'


def test_sentences_are_for_people() -> None:
    assert describe_unexplained_forces([PITCH], [LINE]) == (
        'a pitch moment that varies with surge speed x yaw rate, 1.2 mN m',
        'an oscillation of the specific force upwards at 2.4 Hz, 0.031 m/s2',
    )


def test_a_force_that_stays_the_same_follows_nothing() -> None:
    steady = Remainder('heave', 3.1e-3, 8.0, ('constant',), 0.8)
    assert describe_unexplained_forces([steady]) == ('a constant heave force, 3.1 mN',)
    more = steady._replace(follows=('constant', 'height', 'x', 'surge speed'))
    assert describe_unexplained_forces([more]) == (
        'a heave force that varies with height, x and surge speed, 3.1 mN',
    )


def test_gusts_are_called_gusts() -> None:
    assert is_gusty([SURGE, SWAY])
    assert describe_unexplained_forces([SURGE, SWAY]) == (
        'gusts: random surge and sway forces, 6.2 mN and 5.1 mN',
    )
    assert not is_gusty([SURGE])
    assert not is_gusty([SURGE, SWAY, PITCH])  # of the size of the others
    assert not is_gusty([SURGE._replace(carried=0.5, follows=('x',)), SWAY])


def test_a_wind_to_and_fro_is_no_gusts() -> None:
    assert describe_unexplained_forces([SURGE, SWAY, PITCH], [], [SWING]) == (
        'a pitch moment that varies with surge speed x yaw rate, 1.2 mN m',
        'an oscillation of the force along y of the map at 0.21 Hz, 3.1 mN',
    )
    told = add_oscillations([SURGE, PITCH], dominant_oscillations([SWING]))
    assert told == [
        SURGE._replace(follows=('an oscillation at 0.21 Hz',), carried=0.8), PITCH,
    ]  # fmt: skip
    less = SWING._replace(share=0.3)
    assert describe_unexplained_forces([SURGE, SWAY], [], [less]) == (
        'gusts: random surge and sway forces, 6.2 mN and 5.1 mN',
        'an oscillation of the force along y of the map at 0.21 Hz, 3.1 mN',
    )


def test_a_draught_alone_is_nothing_unexplained() -> None:
    air = DraughtEstimate(1.1e-3, 2.6e-3)
    calm = UnmodeledForces((), (), (), (), air)
    assert (
        calm.decide_verdict(()),
        calm.decide_verdict(('motor_lag',)),
        calm.has_unmodeled_forces,
    ) == (
        'none',
        'named',
        False,
    )
    assert calm.sentences == ()
    assert air.sentence == (
        'a draught: a random horizontal force of 1.1 mN, as from air moving at about 2.6 mm/s'
    )


def test_a_rival_says_what_an_axis_follows() -> None:
    quiet = Remainder('heave', 2e-3, 5.0, (), 0.1)
    assert add_rival_terms([quiet], [LAYERS])[0].follows == ('height',)
    told = quiet._replace(follows=('x',), carried=0.3)
    assert add_rival_terms([told], [LAYERS])[0].follows == ('height',)
    assert add_rival_terms([told], [])[0].follows == ('x',)
    added = add_rival_terms([PITCH], [LAYERS])
    assert [one.axis for one in added] == ['pitch', 'heave']
    assert added[1].size == 3e-3
    assert added[1].floors == pytest.approx(7.5)


@pytest.fixture(scope='module')
def joint(gtmab: tuple[NominalVehicle, list[FreeParameter]]) -> JointFit:
    nominal, known = gtmab
    flight = prepared(flown({}, 5, 14.0), known)
    return EffectSearch(nominal, ([flight], [flight])).run().bare[0]


def test_another_word_for_the_same_puts_no_name_in_question(joint: JointFit) -> None:
    name, rest = 'net_lift.force', UnmodeledForces((), (), ())
    for other, expected in (('ballast.mass', 'named'), ('motor_lag', 'not_identifiable')):
        rivals = {name: (other,)}
        proven = VerifiedEffects((name,), {name: 30.0}, rivals, rivals, joint, joint, joint)
        assert decide_study_verdict(proven, rest, [], 'all') == expected


@pytest.mark.parametrize(
    ('name', 'added', 'expected'),
    [
        ('cg_offset.x', (-0.1, 0.1), 'not_identifiable'),
        ('cg_offset.x', (0.1, 0.3), 'named+unexplained'),
        ('', (-0.1, 0.1), 'unexplained'),
    ],
)
def test_a_hover_that_coasting_forecasts_best_identifies_no_effect_that_adds_nothing(
    joint: JointFit, name: str, added: tuple[float, float], expected: str
) -> None:
    """Though forces are left over in a flight that the model can follow: a draught, say."""
    names, none = (name,) if name else (), {name: ()}
    proven = VerifiedEffects(names, {name: 90.0}, none, none, joint, joint, joint)
    gap = ChannelErrors(
        'position', 'm', 3.0, 0.3, 0.2, 0.19, 0.05, 0.002, 0.3, (0.2, 0.4), 9, added_ci95=added
    )
    rest = UnmodeledForces((PITCH,), (), ())
    assert decide_study_verdict(proven, rest, [gap], 'pose') == expected


def test_a_value_is_known_less_well_beside_what_has_no_name() -> None:
    base = {'unit': '1', 'moves': {}, 'step': 1e-4, 'fine': 1e-4}
    known = [
        FreeParameter('thrust_scale.factor', **base),
        FreeParameter('clock_skew.skew', **base),
    ]
    found = ParameterPosterior(0.0, np.array([0.2, 3e-5]), np.diag([1e-4, 1e-12]))
    alone, beside = (
        parameter_deviations(found, known, False),
        parameter_deviations(found, known, True),
    )
    np.testing.assert_allclose(alone[0], np.hypot(0.01, 0.001), rtol=1e-12)
    np.testing.assert_allclose(beside[0], np.hypot(1.2 * 0.01, 0.001), rtol=1e-12)
    assert alone[1] > 5e-6  # half a millisecond in a hundred seconds
