"""Headline, terminal, JSON, advice and vehicle file say the same about a law."""

from dataclasses import replace

from lta_challenge.contradictions import find_contradictions
from lta_config.schema.vehicle_law import Law, LawFactor, LawTerm
from lta_discovery.conclusion import draw_conclusion, find_law_obstacle
from lta_discovery.finding import (
    ChannelErrors,
    FittedTolerance,
    LawFinding,
    NamedEffect,
    ParameterEstimate,
    StudyResult,
)
from lta_discovery.laws.law_file import BaseFile
from lta_discovery.laws.proposal import add_law
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.page.law_section import list_law_sentences
from lta_discovery.page.verdict_text import format_headline
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.study import DiscoveryStudy
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_model.effects.law import list_law_parameters
from lta_model.vehicle import load_vehicle
import pytest

LAW = Law(
    source='two flights',
    terms=[
        LawTerm(
            axis='pitch',
            coefficient=-0.00031,
            unit='N s2',
            factors=[LawFactor(quantity='speed'), LawFactor(quantity='r')],
            interval=[-0.00034, -0.00028],
            evidence=41.0,
        )
    ],
    region={'speed': [0.0, 0.6], 'r': [-1.0, 1.0]},
)


def errors(*after: float) -> tuple[ChannelErrors, ...]:
    """Return errors of 0.2 with the file, 0.1 without the law, and those with it."""
    both = zip(('position', 'attitude'), ('m', 'rad'), after, strict=True)
    return tuple(
        ChannelErrors(name, unit, 3.0, 0.2, 0.1, value, 1.0, 0.001, 0.5, (0.4, 0.6), 9)
        for name, unit, value in both
    )


UNEXPLAINED = StudyResult(
    'unexplained', (), (), (), errors(0.1, 0.1), True,
    (Remainder('pitch', 4e-4, 10.0, ('yaw rate',), 0.6),), (), 7,
    {'train': ('A',), 'confirm': ('B',), 'holdout': ('C',)}, 'gtmab',
    law=LawFinding(
        LAW, '', errors(0.06, 0.02), ('linear drag (3 nats: too little evidence)',),
        file='a file', tolerances=(
            FittedTolerance('mass', '1', 0.012, 1.2),
            FittedTolerance('height of the centre of gravity', 'm', -0.0015, -0.5),
        ),
    ),
)  # fmt: skip


def test_a_proposed_law_is_said_everywhere() -> None:
    """In words with its unit, with the error that it makes smaller, and what to do with it."""
    said = list_law_sentences(UNEXPLAINED)
    assert said[0].startswith(
        'A law describes it: a pitch moment of -0.00031 N m per (m/s)(rad/s) of airspeed times '
        'yaw rate'
    )
    assert 'the position error is 6 cm with it and 10 cm without' in said[1]
    assert 'linear drag (3 nats: too little evidence)' in said[1]
    assert (
        'vehicle.yaml therefore holds as well, with their source: mass by +1.2 % (+1.2 ' in said[3]
    )
    assert 'height of the centre of gravity by -0.0015 m (-0.5 standard deviations)' in said[3]
    headline = format_headline(UNEXPLAINED)
    assert 'A law of 1 term describes it: with the law, the attitude error' in headline
    assert draw_conclusion(UNEXPLAINED).advice == 'law'
    told = to_dict(UNEXPLAINED)
    assert told['law']['proposed'] is True
    assert told['law']['law']['terms'][0]['coefficient'] == -0.00031
    assert told['law']['tolerances'][0]['deviations'] == 1.2
    assert 'vehicle.yaml' in told['conclusion']['do']
    assert find_contradictions(UNEXPLAINED) == []


def test_a_law_in_the_vehicle_file_stays(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
) -> None:
    """No other is sought, as a file has one law."""
    given = {**gtmab[0].effect_parameters, 'law': list_law_parameters(LAW)}
    nominal = replace(gtmab[0], effect_parameters=given)
    study = DiscoveryStudy(replace(UNEXPLAINED, law=None), nominal, nominal, (), ())
    base = BaseFile('', load_vehicle('gtmab'))
    found = add_law(study, base, lambda _what, _part: None).finding.law
    assert found is not None
    assert found.law is None
    assert 'has a law already' in found.reason


DRAG = NamedEffect(
    'linear_drag', ('linear_drag.surge',),
    (ParameterEstimate('surge', 'N s/m', 0.01, 0.02, (0.015, 0.025)),), 50.0,
)  # fmt: skip


def rest_of(**changes: float) -> tuple[ChannelErrors, ...]:
    """Return position errors of 0.2 with the file and 0.15 with its tolerances, and others."""
    error = ChannelErrors('position', 'm', 3.0, 0.2, 0.15, 0.1, 1.0, 0.001, 0.5, (0.4, 0.6), 9)
    return (replace(error, **changes),)


@pytest.mark.parametrize(
    ('finding', 'reason'),
    [
        (replace(UNEXPLAINED, strained=('mass',)), 'the vehicle file has to be corrected first'),
        (
            replace(UNEXPLAINED, effects=(DRAG,), gaps=rest_of(coast=0.09)),
            'another flight has to be recorded first',
        ),
        (
            replace(
                UNEXPLAINED, effects=(DRAG,), gaps=rest_of(after=0.3, shrink_ci95=(-0.6, -0.4))
            ),
            'the fit to these flights predicts worse than the vehicle file',
        ),
        (replace(UNEXPLAINED, effects=(DRAG,), gaps=rest_of()), ''),
        (UNEXPLAINED, ''),
    ],
)
def test_a_law_needs_the_advice_to_keep_or_use(finding: StudyResult, reason: str) -> None:
    """A law beside the advice to do something else first would be a contradiction."""
    finding = replace(finding, verdict='named+unexplained' if finding.effects else 'unexplained')
    assert find_law_obstacle(finding) == reason
    assert draw_conclusion(finding).advice in ('law', 'use') or reason
    said = 'a law is proposed, but the advice is not to use the file that holds it'
    assert (said in find_contradictions(finding)) == bool(reason)


def test_a_file_that_does_not_beat_coasting_is_useless_with_another_advice() -> None:
    """Only the advice to use the law silences it."""
    finding = replace(
        UNEXPLAINED, verdict='named+unexplained', effects=(DRAG,), gaps=rest_of(coast=0.09)
    )
    assert draw_conclusion(finding).useless is not None
    lost = replace(UNEXPLAINED, gaps=rest_of(coast=0.09))
    assert draw_conclusion(lost).useless is None


def test_without_a_law_the_reason_is_said() -> None:
    """The advice stays, and no output speaks of a law that describes it."""
    found = replace(UNEXPLAINED, law=LawFinding(None, 'no term has enough evidence'))
    assert list_law_sentences(found) == ['No law is proposed for it: no term has enough evidence.']
    assert draw_conclusion(found).advice == 'keep'
    assert 'law' not in format_headline(found)
    assert to_dict(found)['law']['law'] is None
    assert find_contradictions(found) == []
    assert to_dict(replace(found, law=None))['law'] is None
    assert find_contradictions(replace(found, law=None)) == []
