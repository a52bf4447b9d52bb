"""Hidden laws with known coefficients: which terms are selected, and with which numbers."""

from collections.abc import Callable, Iterator
import math
from types import SimpleNamespace
from typing import cast

from lta_config.schema.vehicle_law import HiddenState, Law, LawFactor
from lta_discovery.finding import ChannelErrors, LawFinding
from lta_discovery.fit.evidence import FLOOR
from lta_discovery.forecast.held_out import summarize_residuals
from lta_discovery.forecast.prediction_errors import HORIZONS
from lta_discovery.laws import selection
from lta_discovery.laws.dictionary import build_dictionary, Column, Spread, vary_numbers
from lta_discovery.laws.forecast_refit import FittedLaw
from lta_discovery.laws.law_data import LawData
from lta_discovery.laws.law_model import build_law, list_terms, MARGIN
from lta_discovery.laws.proposal import judge_forecasts, take_first_supported, Trial
from lta_discovery.laws.quantities import filter_hidden, Quantities, thrust_ranges
from lta_discovery.laws.selection import (
    column_costs,
    count_quantities,
    GivenTerms,
    LawFit,
    price_akin_columns,
    select_terms,
    SINGLE,
)
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
import pytest
from scipy.integrate import solve_ivp

from ..synthetic_law import make_law_data  # noqa: TID252 - `test` is Python's own

Array = NDArray[np.float64]
PITCH, YAW, UP = 4, 5, 8


def search(data: LawData) -> tuple[list[tuple[Column, int]], LawFit]:
    """Return the selected terms, and their fit to all flights."""
    chosen, given = select_terms(data, build_dictionary(data.spreads), data.joint.deviations)
    terms = [(data.knots(column), axis) for column, axis in chosen]
    return chosen, LawFit(data, 'all', given.sides[0].deviations, terms)


def test_product_of_speed_and_rate() -> None:
    """A pitch moment of -0.01 N m per (m/s)(rad/s), 20 times the noise, is found as that."""

    def wrench(seen: Quantities) -> dict[int, Array]:
        return {PITCH: -0.01 * seen['u'] * seen['r']}

    data = make_law_data(wrench)
    chosen, fit = search(data)
    assert [axis for _, axis in chosen] == [PITCH]
    assert sorted(factor.quantity for factor in chosen[0][0].factors) == ['r', 'u']
    assert fit.weights[0] == pytest.approx(-0.01, abs=3.0 * fit.deviation[0])
    # 156 readings of 0.3 floors each: a few per cent of the coefficient
    assert fit.deviation[0] < 5e-4
    law = build_law(data, chosen, fit, 'a test')
    term = law.terms[0]
    assert (term.axis, term.unit) == ('pitch', 'N s2')
    assert term.interval is not None
    assert term.interval[0] < -0.01 < term.interval[1]
    assert (term.evidence or 0.0) > 100.0
    # Half of the flown range beyond each of its ends
    low, high = np.min(data.values['u']), np.max(data.values['u'])
    beyond = 0.5 * (high - low)
    assert law.region['u'] == pytest.approx([low - beyond, high + beyond], rel=1e-3)


def test_phase_and_one_side_are_fitted() -> None:
    """Two forms at once: the direction of a magnet, and a flap that damps one way only."""

    def wrench(seen: Quantities) -> dict[int, Array]:
        slip = np.maximum(seen['v'], 0.0)
        return {YAW: 0.0008 * np.sin(seen['yaw'] - 1.0), 1: -0.05 * slip**2}

    chosen, fit = search(make_law_data(wrench, 2))
    assert {axis for _, axis in chosen} == {1, YAW}
    turn = next(column.factors[0] for column, axis in chosen if axis == YAW)
    assert (turn.quantity, turn.form) == ('yaw', 'sin')
    found = [axis for _, axis in chosen].index(YAW)
    # A shift of the phase by pi changes the sign
    phasor = fit.weights[found] * np.exp(1j * (turn.phase or 0.0))
    assert abs(phasor - 0.0008 * np.exp(1j)) < 1e-4
    slip = next(column for column, axis in chosen if axis == 1)
    assert {factor.quantity for factor in slip.factors} == {'v'}
    assert 'positive' in {factor.form for factor in slip.factors}


def test_hidden_state_with_a_lag() -> None:
    """A force that follows the yaw rate with a lag of 1.5 s has a hidden state of that lag."""
    state = HiddenState(drive=[LawFactor(quantity='r')], time_constant=1.5)

    def wrench(seen: Quantities) -> dict[int, Array]:
        return {0: 0.02 * filter_hidden(seen['r'][None], 0.04, state, None)[0][0]}

    chosen, fit = search(make_law_data(wrench, 3))
    column, axis = chosen[0]
    assert axis == 0
    assert column.hidden is not None
    assert [factor.quantity for factor in column.hidden.drive] == ['r']
    assert column.hidden.time_constant == pytest.approx(1.5, rel=0.25)
    assert fit.weights[0] == pytest.approx(0.02, rel=0.15)


def test_a_hidden_state_has_its_own_start() -> None:
    """Lift that returns after a climb: the air inside was as warm as that at 1.1 m."""
    state = HiddenState(drive=[LawFactor(quantity='height')], time_constant=8.0, start=1.1)

    def wrench(seen: Quantities) -> dict[int, Array]:
        # The vehicle of these flights is level
        return {2: 0.08 * filter_hidden(seen['height'][None], 0.04, state, None)[1][0]}

    chosen, fit = search(make_law_data(wrench, 5))
    column, axis = chosen[0]
    assert axis in (2, UP)
    assert [factor.quantity for factor in column.factors] == ['hidden_rate']
    assert column.hidden is not None
    assert [factor.quantity for factor in column.hidden.drive] == ['height']
    assert column.hidden.time_constant == pytest.approx(8.0, rel=0.3)
    # Flights begin at other heights, and fly at 1.5 m in the mean
    assert column.hidden.start == pytest.approx(1.1, abs=0.1)
    assert fit.weights[0] == pytest.approx(0.08, rel=0.25)


def test_a_loss_of_thrust_that_switches_with_a_delay() -> None:
    """A hidden state follows a step of the sink rate; the lost force is a share of the thrust."""
    step = LawFactor(quantity='w', form='above', threshold=-0.1, scale=0.04)
    state = HiddenState(drive=[step], time_constant=0.8)

    def wrench(seen: Quantities) -> dict[int, Array]:
        above = 0.5 * (1.0 + np.tanh((seen['w'] + 0.1) / 0.04))
        held = filter_hidden(above[None], 0.04, state, None)[0][0]
        return {2: 0.4 * seen['thrust_heave'] * held}

    column, axis = search(make_law_data(wrench, 6))[0][0]
    assert axis in (2, UP)
    assert sorted(factor.quantity for factor in column.factors) == ['hidden', 'thrust_heave']
    assert column.hidden is not None
    drive = column.hidden.drive[0]
    assert (drive.quantity, drive.form) == ('w', 'above')
    assert drive.threshold == pytest.approx(-0.1, abs=0.04)


def test_a_field_of_waves_shorter_than_the_area() -> None:
    """Draughts of waves of 1.6 m in flights of 4 m: a product of waves in both directions."""

    def wrench(seen: Quantities) -> dict[int, Array]:
        return {2: 0.008 * np.sin(seen['x'] / 0.25 - 0.6) * np.cos(seen['y'] / 0.3)}

    data = make_law_data(wrench, 7)
    chosen, fit = search(data)
    column, axis = chosen[0]
    assert axis == UP
    lengths = {factor.quantity: factor.scale for factor in column.factors}
    assert lengths == {
        'x': pytest.approx(0.5 * math.pi, rel=0.03), 'y': pytest.approx(0.6 * math.pi, rel=0.03),
    }  # fmt: skip
    # Half a second between knots smooths waves that take two
    assert abs(fit.weights[0]) == pytest.approx(0.008, rel=0.2)
    # Whole waves were flown, so they go on as far as other quantities do
    first = LawFit(data, 'all', data.joint.deviations, list_terms(data, chosen[:1]))
    region = build_law(data, chosen[:1], first, 'a test').region
    for name in 'xy':
        low, high = np.min(data.values[name]), np.max(data.values[name])
        beyond = MARGIN * (high - low)
        assert region[name] == pytest.approx([low - beyond, high + beyond], rel=1e-3)


def test_a_spring_to_a_place() -> None:
    """A yaw moment that grows with the position along y is one term of it, or of its sides."""
    chosen, _ = search(make_law_data(lambda seen: {YAW: 0.0006 * seen['y']}, 4))
    assert [axis for _, axis in chosen] == [YAW]
    assert [(one.quantity, one.form) for one in chosen[0][0].factors] == [('y', 'linear')]


def test_a_chosen_term_is_not_chosen_again() -> None:
    """Also where the flights say so little that the prior of its weight holds it back."""
    data = make_law_data(lambda seen: {PITCH: -0.01 * seen['u'] * seen['r']})
    column = Column((LawFactor(quantity='u'), LawFactor(quantity='r')), 1)
    other = Column((LawFactor(quantity='w'),), 0)
    basis = data.basis([column, other])
    fit = LawFit(data, 'train', 1e3 * data.joint.deviations, [(basis[..., 0], PITCH)])
    inner = fit.residual_products(basis, PITCH)[1]
    assert inner[0] == 0.0
    assert inner[1] > 0.0


def test_terms_that_fall_with_a_new_one_stay_without_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A further term that leaves none beside it is not added; those before it remain."""

    def wrench(seen: Quantities) -> dict[int, Array]:
        return {PITCH: -0.01 * seen['u'] * seen['r'], YAW: 0.0008 * np.sin(seen['yaw'])}

    data = make_law_data(wrench)
    dictionary, deviations = build_dictionary(data.spreads), data.joint.deviations
    first = select_terms(data, dictionary, deviations, 1)[0]

    def drop_all(
        data: LawData, chosen: list[selection.Choice], current: GivenTerms
    ) -> tuple[list[selection.Choice], GivenTerms]:
        both = (chosen, current) if len(chosen) < 2 else ([], GivenTerms.fit(data, deviations, []))
        return both

    monkeypatch.setattr(selection, '_revise', drop_all)
    assert select_terms(data, dictionary, deviations)[0] == first


def test_a_wave_over_height_does_not_reach_beyond_the_flights() -> None:
    """What multiplies it does; a wave over the heading repeats itself."""
    data = make_law_data(lambda seen: {})
    wave = LawFactor(quantity='height', form='sin', scale=2.0)
    turn = LawFactor(quantity='yaw', form='sin')
    columns = [Column((wave, LawFactor(quantity='u')), 1), Column((turn,), 0)]
    chosen = [(column, 0) for column in columns]
    fit = LawFit(data, 'all', data.joint.deviations, list_terms(data, chosen))
    region = build_law(data, chosen, fit, 'a test').region
    for name, beyond in (('height', 0.0), ('u', MARGIN), ('yaw', MARGIN)):
        low, high = np.min(data.values[name]), np.max(data.values[name])
        reach = beyond * (high - low)
        assert region[name] == pytest.approx([low - reach, high + reach], rel=1e-3)


def test_a_hidden_state_begins_within_the_region() -> None:
    """It begins at 0, also where the flights have it far above 0 only."""
    data = make_law_data(lambda seen: {})
    state = HiddenState(
        drive=[LawFactor(quantity='height', form='decay', scale=30.0)], time_constant=0.02
    )
    column = Column((LawFactor(quantity='hidden'),), 2, state)
    fit = LawFit(data, 'all', data.joint.deviations, [(data.knots(column), 0)])
    seen = data.follow(state)['hidden']
    assert seen.min() > MARGIN * np.ptp(seen)
    assert build_law(data, [(column, 0)], fit, 'a test').region['hidden'][0] <= 0.0


def test_a_lag_is_valid_where_its_drive_is() -> None:
    """The range of a drive limits the state and its rate; a second order may overshoot."""
    data = make_law_data(lambda seen: {})
    state = HiddenState(drive=[LawFactor(quantity='height')], time_constant=5.0, start=0.4)
    columns = [Column((LawFactor(quantity=name),), 2, state) for name in ('hidden', 'hidden_rate')]
    chosen = [(column, 0) for column in columns]
    fit = LawFit(data, 'all', data.joint.deviations, list_terms(data, chosen))
    region = build_law(data, chosen, fit, 'a test').region
    low, high = region['height']
    hidden, rate = region['hidden'], region['hidden_rate']
    assert hidden[0] <= 0.4
    assert hidden[1] >= high - 1e-3
    assert rate[0] <= (low - high) / 5.0
    assert rate[1] >= (high - 0.4) / 5.0 - 1e-3


def test_thrusts_are_valid_as_far_as_the_rotors_reach() -> None:
    """Four rotors along surge and heave, by hand; the law of a slow flight holds in a fast one."""
    vehicle = load_vehicle('gtmab')
    ranges = thrust_ranges(vehicle)
    full = [rotor.full_thrust * np.array(rotor.axis) for rotor in vehicle.rotors]
    assert ranges['thrust_surge'][1] == pytest.approx(sum(max(force[0], 0.0) for force in full))
    assert ranges['thrust_heave'][1] == pytest.approx(sum(max(force[2], 0.0) for force in full))
    data = make_law_data(lambda seen: {})
    data.reach = ranges
    column = Column((LawFactor(quantity='u'), LawFactor(quantity='thrust_surge')), 1)
    fit = LawFit(data, 'all', data.joint.deviations, list_terms(data, [(column, 5)]))
    region = build_law(data, [(column, 5)], fit, 'a test').region
    seen, speed = data.values['thrust_surge'], data.values['u']
    assert region['thrust_surge'][1] > 2.0 * np.max(seen)
    assert region['thrust_surge'][1] == pytest.approx(ranges['thrust_surge'][1], rel=1e-3)
    assert region['u'][1] == pytest.approx(np.max(speed) + MARGIN * np.ptp(speed), rel=1e-3)


@pytest.mark.parametrize('seed', range(4))
def test_noise_has_no_law(seed: int) -> None:
    """A wrench that follows nothing, as of gusts, is not described by a law."""
    rng = np.random.default_rng(100 + seed)

    def wrench(seen: Quantities) -> dict[int, Array]:
        # A random force with a memory of 1.5 s, three noise floors
        kept, out = math.exp(-0.04 / 1.5), np.zeros(len(seen['time']))
        for k in range(1, len(out)):
            out[k] = kept * out[k - 1] + math.sqrt(1.0 - kept**2) * rng.standard_normal()
        return {0: 3.0 * FLOOR[0] * out}

    assert search(make_law_data(wrench, seed))[0] == []


@pytest.mark.parametrize(
    ('state', 'rates'),
    [
        ({'time_constant': 0.8}, lambda x, d: [(d - x[0]) / 0.8, 0.0]),
        (
            {'frequency': 4.0, 'damping': 0.2},
            lambda x, d: [x[1], 16.0 * (d - x[0]) - 1.6 * x[1]],
        ),
    ],
)
def test_hidden_state_is_integrated_exactly(state: dict[str, float], rates: object) -> None:
    """From a state that is not at rest, as scipy integrates it under steps of the drive."""
    hidden = HiddenState(drive=[LawFactor(quantity='u')], **state)
    drive, dt = np.array([0.3, -1.0, 0.5, 2.0, 0.0]), 0.1
    begin = np.array([[0.4, 0.0 if hidden.time_constant else -1.2]])
    value, rate = filter_hidden(drive[None], dt, hidden, begin)
    x, expected = begin[0], []
    for d in drive:
        x = solve_ivp(lambda _t, x, d=d: rates(x, d), (0.0, dt), x, rtol=1e-10, atol=1e-12).y[
            :, -1
        ]
        expected.append(x)
    assert value[0] == pytest.approx(np.array(expected)[:, 0], abs=1e-8)
    if not hidden.time_constant:
        assert rate[0] == pytest.approx(np.array(expected)[:, 1], abs=1e-7)


def test_numbers_vary_within_their_form() -> None:
    """A step changes the numbers that a form has, and offers an exponent to a modulus."""
    data = make_law_data(lambda seen: {})
    column = Column((LawFactor(quantity='height', form='decay', scale=0.4),), 0)
    scales = [other.factors[0].scale for other in vary_numbers(column, data.spreads, 0.35)]
    assert scales == pytest.approx([0.4 * math.exp(0.35), 0.4 * math.exp(-0.35)], rel=1e-3)
    modulus = Column((LawFactor(quantity='u', form='modulus'),), 0)
    powers = [other.factors[0].exponent for other in vary_numbers(modulus, data.spreads, 0.1)]
    assert powers == pytest.approx([math.exp(0.1), math.exp(-0.1)], rel=1e-3)


def test_a_constant_quantity_has_no_steps() -> None:
    """A vehicle that never slips has a dictionary without steps of the slip."""
    spreads = make_law_data(lambda seen: {}).spreads | {'v': Spread(0.0, 0.0)}
    forms = {
        one.form
        for column in build_dictionary(spreads)
        for one in column.factors
        if one.quantity == 'v'
    }
    assert 'linear' in forms
    assert not forms & {'above', 'sign'}


def test_terms_beyond_the_size_of_a_law_are_not_chosen() -> None:
    """A law has at most eight quantities."""
    pairs = (('u', 'v'), ('w', 'p'), ('q', 'r'), ('u', 'r'))
    columns = [Column(tuple(LawFactor(quantity=name) for name in pair), 1) for pair in pairs]
    state = HiddenState(drive=[LawFactor(quantity='speed')], time_constant=1.0)
    last = Column((LawFactor(quantity='hidden'),), 2, state)
    assert count_quantities([*columns, last]) == 8


def test_a_law_must_improve_forecasts() -> None:
    """
    One has to get better, and none worse beyond its interval or a twentieth.

    After a law that failed, also what is better has to be so beyond its interval.
    """

    def errors(
        position: float, attitude: float, coast: float = 1.0, half: float = 0.03
    ) -> list[ChannelErrors]:
        rest = {'noise_floor': 0.0, 'shrink': 0.0, 'shrink_ci95': (0.4, 0.6), 'pieces': 9}
        return [
            ChannelErrors(
                name, unit, 3.0, 0.2, 0.1, after, coast, **rest,
                added_ci95=(1.0 - after / 0.1 - half, 1.0 - after / 0.1 + half),
            )
            for name, unit, after in (('position', 'm', position), ('attitude', 'rad', attitude))
        ]  # fmt: skip

    assert judge_forecasts(errors(0.1, 0.05)) == ''
    worse = 'the attitude of held-out flights is predicted worse'
    assert worse in judge_forecasts(errors(0.05, 0.11))
    # By 2 %, which may be chance or not; by 6 %, which would be too much in any case
    assert judge_forecasts(errors(0.05, 0.102)) == ''
    assert worse in judge_forecasts(errors(0.05, 0.102, half=0.01))
    assert worse in judge_forecasts(errors(0.05, 0.106, half=0.2))
    assert 'does not predict' in judge_forecasts(errors(0.099, 0.1))
    # A tenth less, which may be chance if it is not the first test
    assert judge_forecasts(errors(0.09, 0.1, half=0.2)) == ''
    assert 'does not predict' in judge_forecasts(errors(0.09, 0.1, half=0.2), again=True)
    assert judge_forecasts(errors(0.09, 0.1), again=True) == ''
    assert 'coasting' in judge_forecasts(errors(0.09, 0.05, coast=0.08))


def test_laws_are_tested_until_one_passes() -> None:
    """Each once and three at most, as chance passes with every further test."""
    law = build_law_of_nothing()
    made: list[int] = []
    told: list[bool] = []

    def trials(*numbers: float) -> Iterator[Trial]:
        for k, number in enumerate(numbers):
            made.append(k)
            yield Trial([], FittedLaw(np.array([number]), np.zeros(1)))

    def test(passes: float) -> Callable[[Trial, bool], LawFinding]:
        def judge(trial: Trial, again: bool) -> LawFinding:
            told.append(again)
            value = float(trial.fitted.weights[0])
            return LawFinding(law if value == passes else None, f'{value}')

        return judge

    assert take_first_supported(trials(1.0, 1.0, 2.0, 3.0), test(2.0)).law is law
    # The last was not even refitted
    assert made == [0, 1, 2]
    assert told == [False, True]
    none = take_first_supported(trials(1.0, 2.0, 3.0, 4.0), test(4.0))
    assert (none.law, none.reason) == (None, '1.0')


def build_law_of_nothing() -> Law:
    """Return a law that is 0."""
    data = make_law_data(lambda seen: {})
    chosen = [(Column((LawFactor(quantity='u'),), 0), 0)]
    fit = LawFit(data, 'all', data.joint.deviations, list_terms(data, chosen))
    return build_law(data, chosen, fit, 'a test')


def test_blocks_widen_the_interval_of_overlapping_windows() -> None:
    """Four windows of a piece hold the same errors: their interval is that of the pieces."""
    rng = np.random.default_rng(3)
    before, after = rng.uniform(0.5, 1.5, (2, 8, 1, 6))
    flight = SimpleNamespace(
        replay=SimpleNamespace(flight=SimpleNamespace(reading_deviation=np.zeros(14)))
    )

    def interval(times: int, blocks: Array | None, confidence: float = 0.95) -> float:
        offs = {
            name: np.repeat(np.repeat(each, times, axis=0), len(HORIZONS), axis=1)
            for name, each in (
                ('before', before), ('tuned', before), ('after', after), ('coast', before)
            )
        }  # fmt: skip
        flights = cast('list[FlightLinearizer]', [flight])
        error = summarize_residuals(flights, offs, 1, ('position',), blocks, confidence)[-1]
        return error.added_ci95[1] - error.added_ci95[0]

    pieces = interval(1, None)
    assert interval(4, np.repeat(np.arange(8), 4)) == pytest.approx(pieces)
    assert interval(4, None) < 0.7 * pieces
    assert interval(1, None, 0.98) > 1.1 * pieces


def test_a_side_that_did_not_fly_a_term_cannot_support_it() -> None:
    """It may not contradict, and the other side has to be worth more alone."""
    # Pull and information: agreed; not flown; contradicted; neither flown
    sides = (
        (np.array([100.0, 100.0, 100.0, 0.5]), np.array([100.0, 100.0, 100.0, 1.0])),
        (np.array([100.0, -0.3, -50.0, 0.5]), np.array([100.0, 1.0, 100.0, 1.0])),
    )
    data = SimpleNamespace(axis_floor=lambda _axis: 1.0)
    fits = tuple(
        SimpleNamespace(data=data, residual_products=lambda _basis, _axis, own=own: own)
        for own in sides
    )
    given = GivenTerms(cast('tuple[LawFit, LawFit]', fits))
    gains = given.gains(np.ones((2, 3, 4)), 0)
    # Prior sizes of 2, 8 and 30; the weight is 1, or 0.99
    expected = [
        max(0.5 * pull**2 / (inner + s**-2.0) - 0.5 * math.log1p(s**2 * inner) for s in (2.0, 8.0))
        for pull, inner in ((200.0, 200.0), (99.7, 101.0))
    ]
    assert gains[:2] == pytest.approx([expected[0], expected[1] - SINGLE])
    assert np.isneginf(gains[2:]).all()


def test_a_threshold_that_one_flight_never_reaches_does_not_contradict() -> None:
    """A force above a speed that the confirming flight stays below: the other flight decides."""
    data = make_law_data(lambda seen: {}, 2)
    fast, slow = (np.max(data.values['u'][data.rows[side]]) for side in ('train', 'confirm'))
    # The sum of three waves reaches higher in one flight
    assert fast > slow + 0.05
    threshold = float(slow) + 1e-3
    data = make_law_data(lambda seen: {0: 2.0 * np.maximum(seen['u'] - threshold, 0.0)}, 2)
    column = Column((LawFactor(quantity='u', form='positive', threshold=threshold),), 0)
    basis = data.basis([column])
    given = GivenTerms.fit(data, data.joint.deviations, [])
    assert not basis[data.rows['confirm']].any()
    pull, inner = given.sides[0].residual_products(basis, 0)
    usual = FLOOR[0] / np.sqrt(np.mean(basis**2))
    alone = max(
        0.5 * pull[0] ** 2 / (inner[0] + (s * usual) ** -2.0)
        - 0.5 * math.log1p((s * usual) ** 2 * inner[0])
        for s in (2.0, 8.0, 30.0)
    )
    assert alone > 100.0
    assert given.gains(basis, 0)[0] == pytest.approx(alone - SINGLE)


def test_what_is_akin_to_a_chosen_term_costs_less() -> None:
    """The same forms along another axis of the body, and not those of height."""
    columns = build_dictionary(make_law_data(lambda seen: {}).spreads)
    square = [LawFactor(quantity='r'), LawFactor(quantity='r', form='positive')]
    slip = [LawFactor(quantity='v'), LawFactor(quantity='v', form='positive')]
    costs = column_costs(columns)
    priced = price_akin_columns(columns, costs, [Column(tuple(square), 1)])
    forms = [list(one.factors) for one in columns]
    akin, other = forms.index(slip), forms.index([LawFactor(quantity='height')])
    assert priced[akin] < costs[akin] - 3.0
    assert priced[other] == pytest.approx(costs[other] + math.log(2.0))
    assert price_akin_columns(columns, costs, []) is costs
