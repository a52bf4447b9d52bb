"""What counts as a wrong name once the answer is known."""

from typing import Any

from lta_analysis.challenge.judged import judged
import pytest


def _found(*knobs: str) -> dict[str, Any]:
    """Return a finding that names some knobs, and nothing else."""
    effects = [{'name': knob.split('.')[0], 'knobs': [knob], 'parameters': []} for knob in knobs]
    return {'verdict': 'named', 'refused': '', 'effects': effects, 'cpu_s': 1.0}


def _answer(beside: list[str]) -> dict[str, Any]:
    """Return an answer with a wind along y, and what the truth has besides."""
    return {
        'kind': 'single',
        'row': 'other',
        'hidden': [{'knob': 'steady_wind.y', 'value': 0.1}],
        'outside': '',
        'floors': 0.0,
        'nominal': {'given': {}},
        'beside': beside,
    }


@pytest.mark.parametrize(
    ('named', 'beside', 'wrong', 'exact'),
    [
        (('steady_wind.y',), [], (), True),
        (('steady_wind.y', 'wind_gradient.y_z'), ['wind_gradient.y_z'], (), True),
        (('steady_wind.y', 'wind_gradient.y_z'), [], ('wind_gradient.y_z',), False),
        (('wind_gradient.y_z',), ['wind_gradient.y_z'], (), False),
    ],
)
def test_what_the_truth_has_besides_is_no_wrong_name_and_no_right_one(
    named: tuple[str, ...], beside: list[str], wrong: tuple[str, ...], exact: bool
) -> None:
    one = judged(0, _answer(beside), _found(*named))
    assert one.wrong == wrong
    assert one.exact is exact
