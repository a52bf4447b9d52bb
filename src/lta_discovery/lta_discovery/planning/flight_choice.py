"""
Choose the flight that decides between names: each is supposed, flown in process, and compared.

Manoeuvres are flown as the vehicle file has it, the cheapest first. One that promises enough is
flown again with each name supposed to be the truth; only what is safe and decides then is chosen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput, unknown_name
from lta_discovery.fit.evidence import PieceReducer, ReducedFlight, wrench_floor
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.planning.flight_safety import flight_extent, list_objections
from lta_discovery.planning.hypothesis import format_hypothesis
from lta_discovery.planning.maneuvers import (
    AltitudeRange,
    DEEP,
    HIGH,
    list_maneuvers,
    PlannedManeuver,
)
from lta_discovery.planning.rehearsal import (
    prepare_linearizer,
    rehearse_flight,
    RehearsedFlight,
    Sensors,
    with_course,
)
from lta_discovery.planning.separability import PairSeparability
from lta_discovery.replay.linearized_flight import build_origin
from lta_discovery.replay.linearizer import FlightLinearizer
from lta_flight.flight_spec import build_parts, FlightSpec
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.scene_model import vehicle_reach
import numpy as np
from numpy.typing import NDArray
import yaml

Array = NDArray[np.float64]
Tell = Callable[[str, float | None], None]

WANTED: Final = 12.0  # nats to expect: 3 decide, and what comes spreads by the root of twice this
LEAST: Final = 6.0  # nats; a flight that promises less is not worth it
TRIED: Final = 4  # manoeuvres that are flown with each name supposed
SURE: Final = 1.3  # of what is wanted, that a manoeuvre has to promise at the first glance
SEED: Final = 71


class ParameterHypothesis(NamedTuple):
    """A name and its value in the unit of its knob."""

    knob: FreeParameter
    value: float


@final
@dataclass(frozen=True, slots=True)
class DecidingFlight:
    """
    The flight that decides.

    Attributes
    ----------
    manoeuvre : Manoeuvre
        What it does.
    nats : float
        Log Bayes factor to expect of the true name over the other, of the pair that is least
        told apart, when it is flown twice.
    space : tuple of three floats
        Length, width and height that it takes. [m]
    made : Ingredients
        All that decides the flight; the scenario is among it.

    """

    manoeuvre: PlannedManeuver
    nats: float
    space: tuple[float, float, float]
    made: FlightSpec


@final
class NextFlightPlanner:
    """
    A vehicle, its scene and what is known already.

    Parameters
    ----------
    made : Ingredients
        Vehicle, scene and pilot.
    text : str
        The vehicle file.
    sensors : str
        What will be recorded: 'all', 'imu', 'pose'.
    flown : sequence of Reduced
        Flights that there are, about the vehicle file.
    tell : callable
        Told what is being done.

    """

    def __init__(
        self,
        spec: FlightSpec,
        text: str,
        sensors: Sensors = 'all',
        past_flights: Sequence[ReducedFlight] = (),
        tell: Tell = lambda _words, _share: None,
    ) -> None:
        self.made, self.sensors, self.flown, self._tell = spec, sensors, list(past_flights), tell
        self.vehicle, scenario, _ = build_parts(spec)
        self.text, self.nominal = text, NominalVehicle.from_vehicle(self.vehicle)
        self.knobs = list_free_parameters(self.nominal)
        self._names = [knob.name for knob in self.knobs]
        self._floor = wrench_floor(self.nominal)
        standing, top = self.vehicle.height_on_floor, scenario.room.size.vector[2]
        highest = top - vehicle_reach(self.vehicle)[1] - 0.6
        self.space = AltitudeRange(standing + DEEP, min(standing + HIGH, highest))
        if self.space.high < standing + 2.0 * DEEP:
            raise BadInput(
                f'The scenario {scenario.name} is {top:g} m high, too low to fly '
                f'{self.vehicle.file.name} in; plan in another with --scenario.'
            )

    def find_parameter(self, name: str) -> FreeParameter:
        """Return a knob by name; `BadInput` that lists the known ones."""
        if name not in self._names:
            known = [knob.name for knob in self.knobs if knob.typical > 0.0]
            raise unknown_name('effect', name, known)
        return self.knobs[self._names.index(name)]

    def match_rival(self, first: ParameterHypothesis, other: FreeParameter) -> ParameterHypothesis:
        """Return the value at which another name looks most like a first, in what was flown."""
        a, b = self._names.index(first.knob.name), self._names.index(other.name)
        value = other.typical
        if self.flown:
            pair = PairSeparability(self.flown, self.knobs).compare_pair(a, b)
            if pair.second > 0.0:
                value = first.value * pair.shared / pair.second
        within = float(np.clip(value, other.low, other.high))
        return ParameterHypothesis(other, within if within != 0.0 else other.typical)

    def choose_flight(
        self, first: ParameterHypothesis, others: Sequence[ParameterHypothesis]
    ) -> DecidingFlight | None:
        """
        Return the cheapest flight that decides; None where none in the family does safely.

        Parameters
        ----------
        first : Rival
            The name that was found, and its value.
        others : sequence of Rival
            Names that may be meant instead.

        """
        rest: list[tuple[float, PlannedManeuver]] = []
        for one in list_maneuvers(self.space):
            self._tell(f'flying in thought: {one.about}', None)
            nats = self.predict_evidence(one, first, others)
            if nats is None:
                continue
            chosen = self._evaluate_maneuver(one, first, others) if nats > SURE * WANTED else None
            if chosen is not None and chosen.nats >= WANTED:
                return chosen
            rest.append((nats if chosen is None else chosen.nats, one))
        rest.sort(key=lambda pair: -pair[0])
        tried = [self._evaluate_maneuver(one, first, others) for _, one in rest[:TRIED]]
        found = [one for one in tried if one is not None and one.nats >= LEAST]
        return max(found, key=lambda one: one.nats, default=None)

    def predict_evidence(
        self,
        manoeuvre: PlannedManeuver,
        first: ParameterHypothesis,
        others: Sequence[ParameterHypothesis],
    ) -> float | None:
        """Return what a manoeuvre promises as the file has the vehicle; None where unsafe."""
        made = with_course(self.made, manoeuvre.course, manoeuvre.length)
        flown, scenario = self._rehearse(made, self.vehicle)
        if list_objections(flown, self.vehicle, scenario):
            return None
        reduced = self._reduce_rehearsal(flown, self.nominal)
        pairs = [(first, other) for other in others] + [(other, first) for other in others]
        return min(self.expected_evidence(reduced, *pair) for pair in pairs)

    def _evaluate_maneuver(
        self,
        manoeuvre: PlannedManeuver,
        first: ParameterHypothesis,
        others: Sequence[ParameterHypothesis],
    ) -> DecidingFlight | None:
        """Return a manoeuvre if it is safe whichever name is true, and what it promises then."""
        made = with_course(self.made, manoeuvre.course, manoeuvre.length)
        least, spaces = np.inf, []
        for true in (first, *others):
            try:
                vehicle, flown, reduced = self._fly_hypothesis(made, true)
            except BadInput:
                return None
            scenario = build_parts(made)[1]
            if list_objections(flown, vehicle, scenario):
                return None
            spaces.append(flight_extent(flown, vehicle))
            against = others if true is first else (first,)
            least = min(
                least, *(self.expected_evidence(reduced, true, other) for other in against)
            )
        x, y, z = np.max(spaces, axis=0).tolist()
        return DecidingFlight(manoeuvre, float(least), (x, y, z), made)

    def _fly_hypothesis(
        self, spec: FlightSpec, true: ParameterHypothesis
    ) -> tuple[Vehicle, RehearsedFlight, ReducedFlight]:
        """Fly with a name supposed to be the truth; the pilot knows the file."""
        nominal = true.knob.apply_to(self.nominal, true.value)
        content: Any = yaml.safe_load(format_hypothesis(self.text, self.vehicle, nominal))
        changed = FlightSpec(
            spec.names, spec.strategy, {**spec.contents, 'vehicle': content}, spec.replaced
        )
        vehicle = build_parts(changed)[0]
        flown, _ = self._rehearse(spec, vehicle)
        return vehicle, flown, self._reduce_rehearsal(flown, nominal)

    def _rehearse(self, spec: FlightSpec, vehicle: Vehicle) -> tuple[RehearsedFlight, Scenario]:
        """Fly once, the pilot knowing the vehicle file."""
        known, scenario, policy = build_parts(spec)
        return rehearse_flight(vehicle, scenario, policy, SEED, Vehicle(known.file)), scenario

    def _reduce_rehearsal(
        self, rehearsed: RehearsedFlight, nominal: NominalVehicle
    ) -> ReducedFlight:
        """Return what a flight in thought says, about a vehicle."""
        flight = prepare_linearizer(rehearsed.streams, self.vehicle, self.knobs, self.sensors)
        return self.reduce_flight(flight, nominal)

    def reduce_flight(self, flight: FlightLinearizer, nominal: NominalVehicle) -> ReducedFlight:
        """Return what a flight says, about a vehicle."""
        linear = flight.linearize(build_origin(nominal, self.knobs, flight.replay.cut))
        return PieceReducer(linear).reduce(self._floor)

    def expected_evidence(
        self, reduced: ReducedFlight, true: ParameterHypothesis, other: ParameterHypothesis
    ) -> float:
        """Return what to expect of a true name over another once a flight is flown twice."""
        pairs = PairSeparability([*self.flown, reduced, reduced], self.knobs)
        a, b = (self._names.index(one.knob.name) for one in (true, other))
        return pairs.compare_pair(a, b).expected_log_bayes(true.value)
