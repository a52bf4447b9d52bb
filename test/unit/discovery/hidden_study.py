"""A study put together by hand from hidden flights: what the page of a study is drawn from."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from lta_discovery.finding import (
    Discrepancy,
    NamedEffect,
    ParameterEstimate,
    SearchCandidate,
    StudyResult,
)
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import build_prior
from lta_discovery.fit.joint_fit import fit_flight, FlightFit
from lta_discovery.forecast.held_out import compute_model_errors, FlightUnderModels, WHOLE
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint, unchanged_vehicle_point
from lta_discovery.study import DiscoveryStudy, StudyFlight, ThreeModelComparison

from .hidden_flight import flown, prepared

DRAG = 'linear_drag.surge'
PLACES = (
    Discrepancy('hidden_1', 'surge', 2.0, 26.0, 'airspeed above 0.21 m/s', 11.5),
    Discrepancy('hidden_2', 'x', 8.0, 14.0, 'after 8.2 s', 7.25),
)
LADDER = (
    (
        SearchCandidate(DRAG, 41.3, 36.2, 33.7, 0.4, True),
        SearchCandidate('quadratic_drag.surge', 22.1, 19.4, 8.6, 2.2, False),
        SearchCandidate('added_mass.surge', 3.2, -1.7, -4.4, 5.7, False),
    ),
    (SearchCandidate('cg_offset.x', 1.2, -0.6, -0.3, 1.1, False),),
)
WARNINGS = ('The tracker was silent for 2.4 s in hidden_2; that part is left out.',)


def fitted(
    known: tuple[NominalVehicle, Sequence[FreeParameter]],
    flight: FlightLinearizer,
    names: Sequence[str],
) -> FlightFit:
    """Return one flight fitted with some effects."""
    nominal, knobs = known
    begin = unchanged_vehicle_point(nominal, knobs, flight.replay.cut)
    return fit_flight(flight, nominal, build_prior(knobs, names), begin)


def carried(
    known: tuple[NominalVehicle, Sequence[FreeParameter]], flight: FlightLinearizer, of: FlightFit
) -> LinearizationPoint:
    """Return what one flight taught, for another flight."""
    nominal, knobs = known
    values = of.fitted.mean.copy()
    values[: len(knobs)] *= [not knob.per_flight for knob in knobs]
    after, within = apply_parameters(nominal, knobs, values)
    return replace(unchanged_vehicle_point(after, knobs, flight.replay.cut), values=within)


def study(
    known: tuple[NominalVehicle, Sequence[FreeParameter]],
    changes: Mapping[str, object],
    names: Sequence[str] = (DRAG,),
    length: float = 22.0,
    seed: int = 40,
) -> DiscoveryStudy:
    """Return a study of three flights, in the last of which what was learned is shown."""
    nominal, knobs = known
    flights = [prepared(flown(changes, seed + k, length), list(knobs)) for k in range(3)]
    roles = ('train', 'confirm', 'holdout')
    named = [
        StudyFlight(f'hidden_{k}', role, flight)
        for k, (role, flight) in enumerate(zip(roles, flights, strict=True), 1)
    ]
    plain, full = (fitted(known, flights[0], chosen) for chosen in ((), names))
    last = flights[2]
    start = unchanged_vehicle_point(nominal, knobs, last.replay.cut)
    models = FlightUnderModels(start, carried(known, last, plain), carried(known, last, full))
    shown = ThreeModelComparison(named[2], *models)
    finding = StudyResult(
        verdict='named',
        effects=tuple(effect(name, full, knobs) for name in names),
        ladder=LADDER,
        where=PLACES,
        gaps=tuple(compute_model_errors([last], [models], 7, tuple(WHOLE))),
        held_out=True,
        remains=(),
        warnings=WARNINGS,
        seed=7,
        bags={role: (flown.name,) for role, flown in zip(roles, named, strict=True)},
        vehicle='gtmab',
        versions={'lta': '0.1.0', 'commit': 'abcdef0', 'registry': '50 effects'},
    )
    after = shown.after.nominal
    return DiscoveryStudy(finding, nominal, after, tuple(named), (shown,), (plain,), (full,))


def effect(name: str, of: FlightFit, knobs: Sequence[FreeParameter]) -> NamedEffect:
    """Return a named effect with its value by one flight."""
    k = [knob.name for knob in knobs].index(name)
    value, spread = float(of.fitted.mean[k]), 1.96 * float(of.fitted.covariance[k, k]) ** 0.5
    kind, _, parameter = name.partition('.')
    return NamedEffect(
        kind, (name,),
        (
            ParameterEstimate(
                parameter, knobs[k].unit, 0.0, value, (value - spread, value + spread),
            ),
        ),
        77.5, ('quadratic_drag.surge',),
    )  # fmt: skip
