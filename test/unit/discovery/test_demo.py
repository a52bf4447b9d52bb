# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a demonstration hides is drawn by the seed, flown, clear, and in no bag."""

from itertools import islice
from pathlib import Path

from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight
from lta_discovery import demo
from lta_discovery.demo import (
    add_tracker_noise,
    build_demo_course,
    DEMO_SPACING,
    DemoEffect,
    draw_demo_effects,
    ForecastGain,
    HIDEABLE,
    measure_forecast_gain,
    POSE_NOISE,
    TURN_NOISE,
)
from lta_discovery.flights.bags import Role
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .hidden_bags import DRAG


def test_a_seed_draws_effects_of_sizes_within_their_bounds():
    found = [one for seed in range(30) for one in islice(draw_demo_effects(seed), 2)]
    assert next(draw_demo_effects(7)) == next(draw_demo_effects(7))
    assert len({one.value for one in found}) == len(found)
    assert {one.name for one in found} == set(HIDEABLE)
    for one in found:
        low, high = HIDEABLE[one.name]
        assert low <= one.value <= high
    assert DEMO_SPACING > 3  # no flight of one seed is one of the next


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
    duties = flight['motors'].filter(regex=r'^effort').to_numpy()
    assert duties.shape[1] == 4
    assert (duties[500:].std(axis=0) > 0.05).all()  # dither
    assert (duties >= 0.0).all()
    assert (duties <= 1.0).all()


def test_a_tracker_has_the_noise_that_is_said_and_no_velocities():
    rng = np.random.default_rng(1)
    truth = (1.0, 2.0, 3.0, *Rotation.from_rotvec([0.3, 0.2, 0.1]).as_quat(), *[0.5] * 6)
    seen = np.array([add_tracker_noise(truth, rng) for _ in range(4000)])
    assert seen[:, :3].std(axis=0) == pytest.approx(POSE_NOISE, rel=0.1)
    off = (Rotation.from_quat(truth[3:7]).inv() * Rotation.from_quat(seen[:, 3:7])).as_rotvec()
    assert off.std(axis=0) == pytest.approx(TURN_NOISE, rel=0.1)
    assert np.isnan(seen[:, 7:]).all()


def test_courses_change_every_leg_and_not_within():
    plan = build_demo_course(3)
    assert plan(0.1) == plan(7.9)
    assert len({plan(8.0 * k + 1.0) for k in range(20)}) == 20


CLEAR, VAIN = ForecastGain(0.5, 0.2, 0.1), ForecastGain(0.5, 0.19, 0.1)


@pytest.fixture
def flown(monkeypatch: pytest.MonkeyPatch) -> list[DemoEffect]:
    """Leave a file for each flight instead of a bag; return the effects of the flights."""
    effects: list[DemoEffect] = []

    def fly(hidden: DemoEffect, seed: int, seconds: float, folder: Path) -> Path:
        folder.mkdir(parents=True)
        (folder / 'bag').write_text(f'{hidden} {seed} {seconds}')
        effects.append(hidden)
        return folder

    monkeypatch.setattr(demo, 'fly_hidden', fly)
    return effects


@pytest.mark.parametrize(
    ('before', 'tuned', 'is_clear'),
    [(0.5, 0.2, True), (0.49, 0.2, False), (0.5, 0.19, False), (float('inf'), 0.2, True)],
)
def test_an_effect_is_clear_if_both_errors_fall_enough(
    before: float, tuned: float, is_clear: bool
) -> None:
    """To a fifth of that of the file, and half of that with fitted tolerances."""
    assert ForecastGain(before, tuned, 0.1).is_clear == is_clear


def test_another_effect_is_drawn_until_forecasts_need_it(
    flown: list[DemoEffect], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gains, said = [VAIN, VAIN, CLEAR], []
    monkeypatch.setattr(demo, 'measure_forecast_gain', lambda *_: gains.pop(0))
    hidden, bags = demo.draw_clear_effect(3, tmp_path, lambda what, _part: said.append(what))
    drawn = list(islice(draw_demo_effects(3), 3))
    assert hidden == drawn[2]
    assert flown == [one for one in drawn for _ in range(3)]
    assert {role: [one.name for one in each] for role, each in bags.items()} == {
        'train': ['A'], 'confirm': ['B'], 'holdout': ['C'],
    }  # fmt: skip
    assert str(hidden) in (bags['train'][0] / 'bag').read_text()
    assert said.count('checking that forecasts need the hidden effect') == 3
    assert [one for one in said if one.endswith('drawing another')] == [
        f'forecasts do not need effect {count}: drawing another' for count in (1, 2)
    ]


def test_a_seed_without_such_an_effect_is_refused_and_leaves_nothing(
    flown: list[DemoEffect], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(demo, 'measure_forecast_gain', lambda *_: VAIN)
    with pytest.raises(BadInput, match=r'effects that seed 3 draws; choose another --seed\.'):
        demo.run_discovery_demo(3, tmp_path / 'out', lambda _what, _part: None)
    assert len(flown) == 3 * demo.DEMO_DRAWS
    assert list(tmp_path.iterdir()) == []


def test_the_gain_is_that_of_the_effect_that_flew(hidden_bags: tuple[Path, Path, Path]) -> None:
    """With the true drag the held-out flight is forecast well, with another effect it is not."""
    roles: tuple[Role, ...] = 'train', 'confirm', 'holdout'
    bags = {role: [bag] for role, bag in zip(roles, hidden_bags, strict=True)}
    true = measure_forecast_gain(DRAG, bags)
    assert min(true.before, true.tuned) > 1.8 * true.after  # the flights are short
    other = measure_forecast_gain(DemoEffect('cg_offset.x', 0.006, 'm'), bags)
    assert other.before == pytest.approx(true.before)
    assert min(other.before, other.tuned) < 1.05 * other.after
