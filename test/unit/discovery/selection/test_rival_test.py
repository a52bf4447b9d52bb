"""What is outside the library gets no name of the library, and is described."""

from collections.abc import Sequence
from dataclasses import replace
from unittest import mock

from lta_discovery.fit.evidence import build_shared_prior, FLOOR, per_flight_variance
from lta_discovery.fit.joint_fit import JointFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import unchanged_vehicle_point
from lta_discovery.selection.effect_search import EffectSearch
from lta_discovery.selection.effect_verification import EffectVerification
from lta_discovery.selection.residual_guards import (
    find_acting_axes,
    has_no_remainder,
    is_credible,
    is_partial_explanation,
    is_small_motion_effect,
    leaves_larger_remainder,
    leaves_remainder_unchanged,
)
from lta_discovery.selection.rival_test import displacement_threshold, find_better_rival, RivalTest
from lta_discovery.unmodeled.unmodeled_forces import assess_unmodeled_forces
from lta_model.effects.protocol import AXES as NAMES
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own
from ..unknown_physics import KINDS  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]


@pytest.mark.long
def test_a_tether_is_given_no_name(gtmab: Known) -> None:
    nominal, knobs = gtmab
    make, _, strong = KINDS['tether']
    pair = tuple(
        [prepared(flown({}, seed, 32.0, make(strong, np.random.default_rng(4)), 1.9), knobs)]
        for seed in (31, 32)
    )
    found = EffectSearch(nominal, (pair[0], pair[1])).run()
    proven = EffectVerification(nominal, [*pair[0], *pair[1]]).run(found)
    rest = assess_unmodeled_forces(
        pair, proven.full, EffectSearch(nominal, (pair[0], pair[1])).floor
    )
    assert proven.names == ()
    assert rest.decide_verdict(proven.names) == 'unexplained'
    assert {'surge', 'sway', 'heave'} <= {one.axis for one in rest.remains}
    assert all(' force ' in one or ' moment ' in one for one in rest.sentences)


def test_a_candidate_falls_to_a_better_rival_unless_it_has_more_to_say() -> None:
    least = displacement_threshold('net_lift.force', 100.0)
    assert least == pytest.approx(120.0)
    assert (
        find_better_rival(100.0, least, {'field': 119.0}, {'field': 5.0}) == ''
    )  # not clearly better
    assert find_better_rival(100.0, least, {'field': 300.0}, {'field': 203.0}) == 'field'
    assert find_better_rival(100.0, least, {'field': 300.0}, {'field': 290.0}) == ''  # two at once
    assert (
        find_better_rival(100.0, least, {'a': 300.0, 'b': 200.0}, {'a': 290.0, 'b': 90.0}) == 'b'
    )


def test_a_coefficient_of_motion_falls_to_any_better_rival() -> None:
    least = displacement_threshold('rotational_drag.yaw', 43.0)
    assert find_better_rival(43.0, least, {'one-sided': 55.0}, {'one-sided': 17.0}) == 'one-sided'
    assert find_better_rival(43.0, least, {'one-sided': 42.0}, {'one-sided': -12.0}) == ''
    assert (
        find_better_rival(
            43.0, displacement_threshold('ballast.mass', 43.0), {'a': 55.0}, {'a': 17.0}
        )
        == ''
    )


def test_a_part_of_something_larger_is_withdrawn() -> None:
    large = np.array([9.5, 1.0, 20.0, 1.0, 1.0, 1.0])
    heave, yaw = np.arange(6) == 2, np.arange(6) == 5
    assert is_partial_explanation(heave, large, 0.6 * large)
    assert not is_partial_explanation(heave, large, np.array([9.4, 1.0, 3.0, 1.0, 1.0, 1.0]))
    assert not is_partial_explanation(heave, large, 0.3 * large)  # it was most of it
    assert not is_partial_explanation(heave | yaw, large, large)  # it explains one axis
    assert not is_partial_explanation(
        np.zeros(6, dtype=np.bool_), large, large
    )  # it is about a sensor


def test_a_name_that_both_sides_find_may_stand_beside_something_larger() -> None:
    assert is_credible('net_lift.force', (222.0, 157.0), 0.13)
    assert not is_credible('net_lift.force', (222.0, 157.0), 0.27)  # which of the two?
    assert not is_credible('net_lift.force', (148.0, 5.0), 0.13)  # one side hardly knows of it
    assert not is_credible('net_lift.force', (14.0, 11.0), 0.13)
    # The word for whatever follows motion has to come out the same.
    assert not is_credible('linear_drag.surge', (222.0, 157.0), 0.13)
    assert is_credible('added_mass.heave', (84.0, 83.8), 0.002)


def test_what_leaves_all_that_remains_as_it_was_has_nothing_to_do_with_it() -> None:
    before = np.array([10.4, 2.0, 3.9, 6.5, 66.3, 51.9])
    after = np.array([10.0, 2.0, 3.9, 6.4, 62.2, 49.7])
    pitch, sway = np.arange(6) == 4, np.arange(6) == 1
    assert leaves_remainder_unchanged(before, after)
    assert leaves_remainder_unchanged(before, after - 1.5 * sway)  # what is calm does not count
    assert not leaves_remainder_unchanged(before, after - 10.0 * pitch)
    assert not leaves_remainder_unchanged(before, after + 20.0 * pitch)
    assert has_no_remainder(sway, after)
    assert not has_no_remainder(sway | pitch, after)
    assert has_no_remainder(np.zeros(6, dtype=np.bool_), after)  # it is about a sensor


def test_less_is_asked_of_what_has_nothing_to_do_with_a_rival() -> None:
    least, before, after = (
        displacement_threshold('tracker_delay.delay', 124.0),
        {'roll': 340.0},
        {'roll': 264.0},
    )
    assert find_better_rival(124.0, least, before, after) == 'roll'
    assert find_better_rival(124.0, least, before, after, part=0.25) == ''
    assert find_better_rival(124.0, least, before, {'roll': 220.0}, part=0.25) == 'roll'


def test_a_coefficient_of_motion_that_leaves_more_than_it_explains_is_minor() -> None:
    before = np.array([0.4, 0.4, 0.4, 1.3, 3.3, 5.4])
    final = np.array([0.3, 0.4, 0.4, 1.3, 2.9, 4.7])
    pitch, yaw = (np.arange(6) == 4) | (np.arange(6) == 0), np.arange(6) == 5
    assert leaves_larger_remainder('rotational_drag.pitch', pitch, before, final)
    assert leaves_larger_remainder('rotational_drag.yaw', yaw, before, final)
    assert not leaves_larger_remainder('ballast.mass', yaw, before, final)
    assert not leaves_larger_remainder(
        'rotational_drag.yaw', yaw, before, final - 2.5 * yaw
    )  # little is left
    assert not leaves_larger_remainder(
        'rotational_drag.yaw', yaw, before + 4.0, final
    )  # it explained more


def test_a_name_that_won_little_is_withdrawn_beside_anything(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    nominal, knobs = gtmab
    fitter = JointFitter(nominal, [clean], per_flight_variance(knobs), FLOOR)
    begin = unchanged_vehicle_point(nominal, knobs, clean.replay.cut)
    joint = fitter.fit(
        build_shared_prior(knobs), fitter.linearize_flights(begin.values, [begin]), FLOOR, rounds=1
    )
    displacing = RivalTest(([clean], [clean]), FLOOR)

    def gone(won: float, floors: float) -> tuple[str, ...]:
        then = replace(joint, evidence=joint.evidence + 0.5 * won, deviations=floors * FLOOR)
        return displacing.list_withdrawn_effects(
            [('helium_leak.rate', (joint, joint))], (then, then)
        )

    assert gone(20.0, 3.0) == ('helium_leak.rate',)
    assert gone(20.0, 2.0) == ()  # nothing remains
    assert gone(28.0, 3.0) == ()  # it won enough
    assert gone(28.0, 21.0) == ('helium_leak.rate',)  # not beside a force that drowns it

    def of_a_sensor(won: float, floors: float) -> tuple[str, ...]:
        then = replace(joint, evidence=joint.evidence + 0.5 * won, deviations=floors * FLOOR)
        return displacing.list_withdrawn_effects(
            [('range_offset.offset', (joint, joint))], (then, then)
        )

    assert of_a_sensor(12.0, 3.0) == ()  # no force could say the same

    def of_a_drag(won: float, remaining: Sequence[float]) -> tuple[str, ...]:
        then = replace(
            joint, evidence=joint.evidence + 0.5 * won, deviations=FLOOR * np.array(remaining)
        )
        return displacing.list_withdrawn_effects(
            [('linear_drag.heave', (joint, joint))], (then, then)
        )

    gusts, surge = (5.0, 5.0, 1.0, 1.0, 1.0, 1.0), (5.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    assert of_a_drag(18.0, gusts) == ('linear_drag.heave',)  # air that moves up and down, too
    assert of_a_drag(28.0, gusts) == ()
    assert of_a_drag(18.0, surge) == ()  # another force, on one axis

    def with_two_values(floors: float) -> tuple[str, ...]:
        """Return what is withdrawn if the sides differ by 2.8 deviations."""
        k, sides = [knob.name for knob in knobs].index('range_offset.offset'), []
        for value in (1.0, 1.4):
            mean, covariance = joint.fitted.mean.copy(), joint.fitted.covariance.copy()
            mean[k], covariance[k, k] = value, 0.1**2
            fitted = joint.fitted._replace(mean=mean, covariance=covariance)
            sides.append(
                replace(joint, fitted=fitted, evidence=joint.evidence + 20.0, deviations=3 * FLOOR)
            )
        before = replace(joint, deviations=floors * FLOOR)
        return displacing.list_withdrawn_effects(
            [('range_offset.offset', (before, before))], (sides[0], sides[1])
        )

    assert with_two_values(5.0) == ('range_offset.offset',)  # it took a part of the remainder
    assert with_two_values(3.0) == ()  # it has nothing to do with the remainder


@pytest.mark.parametrize(
    ('name', 'gains', 'part', 'rival', 'stays'),
    [
        ('motor_lag', (660.0, 645.0), 0.02, 70.0, True),
        ('motor_lag', (660.0, 645.0), 0.02, 330.0, False),  # a rival explains a quarter of it
        ('motor_lag', (660.0, 645.0), 0.11, 70.0, False),  # the sides disagree about the value
        ('motor_lag', (660.0, 79.0), 0.02, 70.0, False),  # one side shows little
        ('linear_drag.surge', (660.0, 645.0), 0.02, 70.0, False),  # it fits whatever moves
    ],
)
def test_what_no_rival_comes_near_stands_beside_any_remainder(
    name: str, gains: tuple[float, float], part: float, rival: float, stays: bool
) -> None:
    displacing = object.__new__(RivalTest)
    with mock.patch.object(RivalTest, '_rival_gains', return_value={'a': 3.0, 'b': rival}):
        assert displacing._is_unrivalled(name, ('fits', 'fits'), gains, part) == stays


def test_drag_for_a_little_beside_something_large_is_withdrawn() -> None:
    before = np.array([2.4, 2.5, 3.3, 6.2, 5.4, 0.6])
    final = np.array([1.1, 2.4, 3.2, 6.2, 5.4, 0.6])
    surge, none = np.arange(6) == 0, np.zeros(6, dtype=np.bool_)
    assert is_small_motion_effect('linear_drag.surge', surge, before, final)
    assert not is_small_motion_effect('linear_drag.surge', surge, before + 2.0 * surge, final)
    assert is_small_motion_effect(
        'linear_drag.surge', surge, before + 2.0, final + 2.0
    )  # it hardly changed
    assert not is_small_motion_effect(
        'net_lift.force', surge, before, final
    )  # it follows no motion
    assert not is_small_motion_effect('added_mass.surge', none, before, final)
    assert is_small_motion_effect('munk_moment.lost', surge, before, final)


def test_a_knob_acts_where_a_force_could_do_the_same(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    nominal, knobs = gtmab
    linear = clean.linearize(unchanged_vehicle_point(nominal, knobs, clean.replay.cut))
    for name, axes in (
        ('linear_drag.heave', ['heave']),
        ('rotational_drag.yaw', ['yaw']),
        ('range_offset.offset', []),
    ):
        assert [NAMES[k] for k in np.flatnonzero(find_acting_axes(linear, name, FLOOR))] == axes
