"""A demonstration hides an effect that forecasts need, or draws another."""

from itertools import islice
from pathlib import Path

from lta_config.errors import BadInput
from lta_discovery.demo import demo
from lta_discovery.demo.forecast_gain import ForecastGain, measure_forecast_gain
from lta_discovery.demo.hidden_effect import DemoEffect, draw_demo_effects
from lta_discovery.flights.bags import Role
import pytest

from ..hidden_bags import DRAG  # noqa: TID252 - `test` is Python's own

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
    assert len(flown) == 3 * demo.DRAWS
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
