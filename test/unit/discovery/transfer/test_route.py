"""When forecasts are asked for names, and that tolerances alone give none."""

from dataclasses import replace

from lta_discovery.finding import DiscoveryFinding, Verdict
from lta_discovery.flights.role_assignment import select_part
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_discovery.study import DiscoveryStudy, StudyFlight
from lta_discovery.transfer import forecast_naming
from lta_discovery.transfer.cross_validation import RegimeError, remaining_error_share
from lta_discovery.transfer.forecast_naming import (
    format_interpolation,
    format_tolerance_share,
    LOOSE,
    name_by_forecasts,
    needs_forecasts,
    TransferOutcome,
)
from lta_discovery.transfer.forward_selection import GroupSelection
from lta_discovery.unmodeled.remainders import Remainder
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]
LEFT = (Remainder('heave', 0.02, 30.0, (), 0.0),)


def poses_alone(
    flight: FlightLinearizer,
    knobs: list[FreeParameter],
    alike: float,
    begin: float = 0.0,
    end: float = 1.0,
) -> FlightLinearizer:
    """Return a part of a flight of which only a tracker is left, filtered or not."""
    bare = FlightLinearizer(flight.replay.with_pieces(flight.replay.cut), knobs, flight.places)
    noise = np.where(np.arange(14) < 6, 1e-3, np.inf)
    told = select_part(flight.replay.flight, begin, end)
    bare.replay.flight = replace(told, noise=noise, alike=alike)
    return bare


def unnamed(
    nominal: NominalVehicle, flights: list[StudyFlight], verdict: Verdict = 'unexplained'
) -> DiscoveryStudy:
    """Return a study whose readings gave no name."""
    finding = DiscoveryFinding(verdict, (), (), (), (), False, LEFT, (), 1, {}, 'gtmab')
    return DiscoveryStudy(finding, nominal, nominal, flights, [])


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
    gtmab: Known, clean: FlightLinearizer, verdict, alike, flights, asked
) -> None:
    bare = poses_alone(clean, gtmab[1], alike)
    blind = [StudyFlight(f'{k}', 'train', bare) for k in range(flights)]
    assert needs_forecasts(unnamed(gtmab[0], blind, verdict)) is asked
    seeing = [StudyFlight(f'{k}', 'train', clean) for k in range(flights)]
    assert not needs_forecasts(unnamed(gtmab[0], seeing, verdict))


@pytest.mark.parametrize(('share', 'asked'), [(0.99 * LOOSE, False), (1.01 * LOOSE, True)])
def test_what_tolerances_explain_is_given_no_name(
    gtmab: Known, clean: FlightLinearizer, monkeypatch, share, asked
) -> None:
    """By what tolerances leave in regimes left out, just below the limit and just above it."""
    nominal, knobs = gtmab
    parts = [('train', 0.0, 0.5), ('confirm', 0.5, 1.0)] * 2
    flights = [
        StudyFlight(f'{k}', role, poses_alone(clean, knobs, 12.5, begin, end))
        for k, (role, begin, end) in enumerate(parts)
    ]
    looked = []

    def standing(*given: object) -> TransferOutcome:
        looked.append(given)
        return TransferOutcome(GroupSelection((), (), np.zeros(len(knobs)), (), 1.0), (), None, ())

    regimes = [
        RegimeError('slow', 3, 2.0, 2.0 * share**0.5),
        RegimeError('fast', 1, 1.0, share**0.5),
    ]
    monkeypatch.setattr(
        forecast_naming, 'tune_tolerances', lambda *_: (np.zeros(len(knobs)), regimes)
    )
    monkeypatch.setattr(forecast_naming, '_select_groups', standing)
    before = unnamed(nominal, flights)
    found = name_by_forecasts(before, lambda what, share: None).finding
    assert (found.verdict, found.effects, bool(looked)) == ('unexplained', (), asked)
    said = () if asked else (format_tolerance_share(share),)
    assert found.warnings == said
    assert remaining_error_share(regimes) == pytest.approx(share)


def test_what_only_interpolates_is_said_so() -> None:
    assert format_interpolation(['side force']).startswith('side force: interpolation only')
