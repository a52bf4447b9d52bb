"""What the demonstration hides is drawn by the seed, flown, and stands in no bag."""

from itertools import islice

from lta_data.bag.recorded_flight import open_flight
from lta_discovery.demo.demo import APART
from lta_discovery.demo.hidden_effect import (
    add_tracker_noise,
    build_demo_course,
    DemoEffect,
    draw_demo_effects,
    HIDEABLE,
    POSE,
    TURN,
)
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation


def test_a_seed_draws_effects_of_sizes_within_their_bounds():
    found = [one for seed in range(30) for one in islice(draw_demo_effects(seed), 2)]
    assert next(draw_demo_effects(7)) == next(draw_demo_effects(7))
    assert len({one.value for one in found}) == len(found)
    assert {one.name for one in found} == set(HIDEABLE)
    for one in found:
        low, high = HIDEABLE[one.name]
        assert low <= one.value <= high
    assert APART > 3  # no flight of one seed is one of the next


@pytest.mark.parametrize('name', HIDEABLE)
def test_what_is_hidden_is_in_the_vehicle_that_flies(name):
    high = HIDEABLE[name][1]
    hidden = DemoEffect(name, high, '')
    made_of = load_spec('gtmab', 'lamp_room', 'bag', '')
    effect, parameter = name.split('.')
    values = {}
    for key, given in (
        ('plain', made_of),
        ('hidden', hidden.hide_in(made_of)),
    ):
        values[key] = build_vehicle_scenario_stack(given)[0].collect_effects()
    assert values['hidden'][effect][parameter] == high  # exactly
    assert values['plain'].get(effect, {}).get(parameter, 0.0) == 0.0
    del values['hidden'][effect][parameter]
    if effect in values['plain']:
        del values['plain'][effect][parameter]
    else:
        assert values['hidden'].pop(effect) == {}
    assert values['hidden'] == values['plain']


def test_bags_say_nothing_of_what_is_hidden(hidden_bags):
    flight = open_flight(hidden_bags[0])
    told = flight.bag.provenance
    assert told['data'] == 'simulated'
    assert not any('0.04' in text and 'linear_drag' in text for text in told.values())
    duties = np.column_stack([flight.read_series('motors')[f'effort[{k}]'] for k in range(4)])
    assert (duties[500:].std(axis=0) > 0.05).all()  # dither
    assert (duties >= 0.0).all()
    assert (duties <= 1.0).all()


def test_a_tracker_has_the_noise_that_is_said_and_no_velocities():
    rng = np.random.default_rng(1)
    truth = (1.0, 2.0, 3.0, *Rotation.from_rotvec([0.3, 0.2, 0.1]).as_quat(), *[0.5] * 6)
    seen = np.array([add_tracker_noise(truth, rng) for _ in range(4000)])
    assert seen[:, :3].std(axis=0) == pytest.approx(POSE, rel=0.1)
    off = (Rotation.from_quat(truth[3:7]).inv() * Rotation.from_quat(seen[:, 3:7])).as_rotvec()
    assert off.std(axis=0) == pytest.approx(TURN, rel=0.1)
    assert np.isnan(seen[:, 7:]).all()


def test_courses_change_every_leg_and_not_within():
    plan = build_demo_course(3)
    assert plan(0.1) == plan(7.9)
    assert len({plan(8.0 * k + 1.0) for k in range(20)}) == 20
