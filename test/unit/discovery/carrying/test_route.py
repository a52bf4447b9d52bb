"""When forecasts are asked for names, and that tolerances alone give none."""

from dataclasses import replace

from lta_discovery.carrying import route
from lta_discovery.carrying.choose import Chosen
from lta_discovery.carrying.route import (
    by_forecasts,
    due,
    interpolating,
    LOOSE,
    Names,
    within_tolerances,
)
from lta_discovery.carrying.transfer import left, Regime
from lta_discovery.finding import Finding, Verdict
from lta_discovery.flights.splitting import part
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.outside.unexplained import Remainder
from lta_discovery.replay.linearise import Linearised
from lta_discovery.study import Flown, Study
import numpy as np
import pytest

Known = tuple[Nominal, list[Knob]]
LEFT = (Remainder('heave', 0.02, 30.0, (), 0.0),)


def poses_alone(
    flight: Linearised, knobs: list[Knob], alike: float, begin: float = 0.0, end: float = 1.0
) -> Linearised:
    """Return a part of a flight of which only a tracker is left, filtered or not."""
    bare = Linearised(flight.replay.in_pieces(flight.replay.cut), knobs, flight.places)
    noise = np.where(np.arange(14) < 6, 1e-3, np.inf)
    told = part(flight.replay.flight, begin, end)
    bare.replay.flight = replace(told, noise=noise, alike=alike)
    return bare


def unnamed(nominal: Nominal, flights: list[Flown], verdict: Verdict = 'unexplained') -> Study:
    """Return a study whose readings gave no name."""
    finding = Finding(verdict, (), (), (), (), False, LEFT, (), 1, {}, 'gtmab')
    return Study(finding, nominal, nominal, flights, [])


@pytest.mark.parametrize(
    ('verdict', 'alike', 'flights', 'asked'),
    [
        ('none', 12.5, 9, False),
        ('named', 12.5, 9, False),
        ('unexplained', 12.5, 3, False),
        ('unexplained', 12.5, 4, True),
        ('unexplained', 1.0, 4, False),
        ('unexplained', 1.0, 8, True),
        ('not_identifiable', 12.5, 4, True),
    ],
)
def test_forecasts_are_asked_where_readings_have_no_name(
    gtmab: Known, clean: Linearised, verdict, alike, flights, asked
) -> None:
    bare = poses_alone(clean, gtmab[1], alike)
    blind = [Flown(f'{k}', 'train', bare) for k in range(flights)]
    assert due(unnamed(gtmab[0], blind, verdict)) is asked
    seeing = [Flown(f'{k}', 'train', clean) for k in range(flights)]
    assert not due(unnamed(gtmab[0], seeing, verdict))


@pytest.mark.parametrize(('share', 'asked'), [(0.99 * LOOSE, False), (1.01 * LOOSE, True)])
def test_what_tolerances_explain_is_given_no_name(
    gtmab: Known, clean: Linearised, monkeypatch, share, asked
) -> None:
    """By what tolerances leave in regimes left out, just below the limit and just above it."""
    nominal, knobs = gtmab
    parts = [('train', 0.0, 0.5), ('confirm', 0.5, 1.0)] * 2
    flights = [
        Flown(f'{k}', role, poses_alone(clean, knobs, 12.5, begin, end))
        for k, (role, begin, end) in enumerate(parts)
    ]
    looked = []

    def standing(*given: object) -> Names:
        looked.append(given)
        return Names(Chosen((), (), np.zeros(len(knobs)), (), 1.0), (), None, ())

    regimes = [Regime('slow', 3, 2.0, 2.0 * share**0.5), Regime('fast', 1, 1.0, share**0.5)]
    monkeypatch.setattr(route, 'tuned', lambda *_: (np.zeros(len(knobs)), regimes))
    monkeypatch.setattr(route, '_standing', standing)
    before = unnamed(nominal, flights)
    found = by_forecasts(before, lambda what, share: None).finding
    assert (found.verdict, found.effects, bool(looked)) == ('unexplained', (), asked)
    said = () if asked else (within_tolerances(share),)
    assert found.warnings == said
    assert left(regimes) == pytest.approx(share)


def test_what_only_interpolates_is_said_so() -> None:
    assert interpolating(['side force']).startswith('side force: interpolation only')
