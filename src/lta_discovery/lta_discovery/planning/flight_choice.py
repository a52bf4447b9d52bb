"""
Choose the flight that best separates candidate effects, by simulation.

Manoeuvres are simulated with the vehicle file, the cheapest first. A promising one is simulated
again with each effect assumed true. It is chosen if it is safe and conclusive in all cases.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
import math
from typing import Any, Final, final, NamedTuple

from lta_config.errors import BadInput, unknown_name_error
from lta_discovery.changed_quantities import format_hypothesis
from lta_discovery.flights.usable_flights import SATURATED_DUTY
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, list_free_parameters
from lta_discovery.planning.candidate_maneuvers import (
    AltitudeRange,
    DEEP,
    HIGH,
    list_maneuvers,
    PlannedManeuver,
)
from lta_discovery.planning.rehearsal import (
    CLEAR,
    measure_information,
    measure_rehearsal,
    Sensors,
    simulate_flight,
    SimulatedFlight,
    with_course,
)
from lta_discovery.planning.separability import PairSeparability
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.readings import FlightOutcome
from lta_sim.scene_model import vehicle_reach
import numpy as np
from numpy.typing import NDArray
import yaml

Array = NDArray[np.float64]
Tell = Callable[[str, float | None], None]

WANTED: Final = 12.0  # nats to expect: 3 decide, the standard deviation is the root of 24
LEAST_EVIDENCE: Final = 6.0  # nats; a flight with less expected evidence is not proposed
TRIED: Final = 4  # manoeuvres that are simulated with each effect
SURE: Final = 1.3  # of WANTED; required in the first simulation
SEED: Final = 71
MARGIN: Final = 0.3  # m between the hull and walls or ceiling
LARGEST_TILT: Final = math.radians(30.0)
SATURATED_SHARE: Final = 0.15  # of the flight; longest saturation of any rotor


class ParameterHypothesis(NamedTuple):
    """A parameter and its hypothetical value."""

    knob: FreeParameter
    value: float


@final
@dataclass(frozen=True, slots=True)
class FlightChoice:
    """The chosen flight."""

    manoeuvre: PlannedManeuver
    # Expected log Bayes factor of the true effect over another, for the worst pair and two flights
    nats: float
    space: tuple[float, float, float]  # required length, width and height [m]
    flight_spec: FlightSpec  # specification of the flight, including the scenario


@final
class NextFlightPlanner:
    """
    Plan the next flight of a vehicle, about whose parameters earlier flights tell nothing.

    `text`: of its file. `parameters`: that may differ from it; by default those of a vehicle that
    is commanded by duties.
    """

    def __init__(
        self,
        spec: FlightSpec,
        text: str,
        sensors: Sensors = 'all',
        tell: Tell = lambda _words, _share: None,
        parameters: Sequence[FreeParameter] = (),
    ) -> None:
        self.made, self.sensors, self._tell = spec, sensors, tell
        self.vehicle, scenario, _ = build_vehicle_scenario_stack(spec)
        self.text, self.nominal = text, NominalVehicle.from_vehicle(self.vehicle)
        self.knobs = list(parameters) or list_free_parameters(self.nominal)
        self._names = [knob.name for knob in self.knobs]
        standing, top = self.vehicle.hull_height_on_floor, scenario.room.size.vector[2]
        # 0.6 m between hull and ceiling: twice the margin of `flight_safety`
        highest = top - vehicle_reach(self.vehicle)[1] - 0.6
        self.space = AltitudeRange(standing + DEEP, min(standing + HIGH, highest))
        if self.space.high < standing + 2.0 * DEEP:
            raise BadInput(
                f'The room of the scenario {scenario.name} is {top:g} m high, too low for the '
                f'vehicle {self.vehicle.file.name}; choose a higher one with --scenario.'
            )

    def find_parameter(self, name: str) -> FreeParameter:
        """Return a parameter by name; raise `BadInput` with the known names."""
        if name not in self._names:
            names = [knob.name for knob in self.knobs if knob.typical > 0.0]
            raise unknown_name_error('effect', name, names)
        return self.knobs[self._names.index(name)]

    def choose_flight(
        self, first: ParameterHypothesis, others: Sequence[ParameterHypothesis]
    ) -> FlightChoice | None:
        """Return the cheapest safe and conclusive flight, or None."""
        rest: list[tuple[float, PlannedManeuver]] = []
        for one in list_maneuvers(self.space):
            self._tell(f'simulating: {one.about}', None)
            nats = self.predict_evidence(one, first, others)
            if nats is None:
                continue
            # Simulating every hypothesis is slow: only if the first estimate is promising
            chosen = self._evaluate_maneuver(one, first, others) if nats > SURE * WANTED else None
            if chosen is not None and chosen.nats >= WANTED:
                return chosen
            rest.append((nats if chosen is None else chosen.nats, one))
        # None reaches the wanted evidence: take the best of the others
        rest.sort(key=lambda pair: -pair[0])
        tried = [self._evaluate_maneuver(one, first, others) for _, one in rest[:TRIED]]
        useful = [one for one in tried if one is not None and one.nats >= LEAST_EVIDENCE]
        return max(useful, key=lambda one: one.nats, default=None)

    def predict_evidence(
        self,
        manoeuvre: PlannedManeuver,
        first: ParameterHypothesis,
        others: Sequence[ParameterHypothesis],
    ) -> float | None:
        """Return the expected evidence of a manoeuvre; None if it is unsafe."""
        spec = with_course(self.made, manoeuvre.course, manoeuvre.length)
        flight, scenario = self._simulate_flight(spec, self.vehicle)
        if list_objections(flight, self.vehicle, scenario):
            return None
        reduced = self._inform(flight, self.nominal)
        # Either effect may be the true one
        pairs = [(first, other) for other in others] + [(other, first) for other in others]
        return min(self.expected_evidence(reduced, *pair) for pair in pairs)

    def _evaluate_maneuver(
        self,
        manoeuvre: PlannedManeuver,
        first: ParameterHypothesis,
        others: Sequence[ParameterHypothesis],
    ) -> FlightChoice | None:
        """Return a manoeuvre with its evidence; None if unsafe under any hypothesis."""
        spec = with_course(self.made, manoeuvre.course, manoeuvre.length)
        least, spaces = np.inf, []
        for true in (first, *others):
            try:
                vehicle, flight, reduced = self._fly_hypothesis(spec, true)
            except BadInput:
                return None
            scenario = build_vehicle_scenario_stack(spec)[1]
            if list_objections(flight, vehicle, scenario):
                return None
            spaces.append(flight_extent(flight, vehicle))
            # Rivals need not be separated from one another
            against = others if true is first else (first,)
            least = min(
                least, *(self.expected_evidence(reduced, true, other) for other in against)
            )
        x, y, z = np.max(spaces, axis=0).tolist()
        return FlightChoice(manoeuvre, float(least), (x, y, z), spec)

    def _fly_hypothesis(
        self, spec: FlightSpec, true: ParameterHypothesis
    ) -> tuple[Vehicle, SimulatedFlight, Array]:
        """Simulate a flight with a hypothesis as the truth; the controller uses the file."""
        nominal = true.knob.apply_to(self.nominal, true.value)
        content: Any = yaml.safe_load(format_hypothesis(self.text, self.vehicle, nominal))
        changed = FlightSpec(
            spec.names, spec.strategy, {**spec.contents, 'vehicle': content}, spec.replaced
        )
        vehicle = build_vehicle_scenario_stack(changed)[0]
        flight, _ = self._simulate_flight(spec, vehicle)
        return vehicle, flight, self._inform(flight, nominal)

    def _simulate_flight(
        self, spec: FlightSpec, vehicle: Vehicle
    ) -> tuple[SimulatedFlight, Scenario]:
        """Simulate a flight once; the controller uses the vehicle file."""
        nominal, scenario, policy = build_vehicle_scenario_stack(spec)
        return simulate_flight(vehicle, scenario, policy, SEED, Vehicle(nominal.file)), scenario

    def _inform(self, rehearsed: SimulatedFlight, nominal: NominalVehicle) -> Array:
        """Return the information of a simulated flight, about a vehicle, shape (K, K)."""
        flight = measure_rehearsal(rehearsed.streams, self.vehicle, self.sensors)
        return measure_information(flight, self.vehicle, nominal, self.knobs)

    def expected_evidence(
        self, reduced: Array, true: ParameterHypothesis, other: ParameterHypothesis
    ) -> float:
        """Return the expected evidence for a true effect over another, after two flights."""
        # Twice: the plan is to fly it two times
        pairs = PairSeparability([reduced, reduced], self.knobs)
        a, b = (self._names.index(one.knob.name) for one in (true, other))
        return pairs.compare_pair(a, b).expected_log_bayes(true.value)


def list_objections(rehearsed: SimulatedFlight, vehicle: Vehicle, scenario: Scenario) -> list[str]:
    """Return the reasons not to fly a flight; empty if it is safe."""
    out = []
    if rehearsed.outcome is not FlightOutcome.REACHED:
        out.append(f'it {rehearsed.outcome}')
    length, width, height = scenario.room.size.vector
    radius, half_height = vehicle_reach(vehicle)
    # The room is centred on the origin of the map
    near = np.abs(rehearsed.path[:, :2]).max(axis=0) + radius + MARGIN
    if near[0] > length / 2.0 or near[1] > width / 2.0:
        out.append(f'it comes within {MARGIN:g} m of a wall')
    if rehearsed.path[:, 2].max() + half_height + MARGIN > height:
        out.append(f'it comes within {MARGIN:g} m of the ceiling')
    if rehearsed.tilt > LARGEST_TILT:
        out.append(
            f'it tilts by {math.degrees(rehearsed.tilt):.0f} degrees, more than '
            f'{math.degrees(LARGEST_TILT):.0f}'
        )
    if np.max(np.mean(np.abs(rehearsed.duties) >= SATURATED_DUTY, axis=0)) > SATURATED_SHARE:
        out.append('a rotor is saturated for too long')
    if rehearsed.path[-1, 2] > rehearsed.standing + CLEAR:
        out.append('it does not land')
    return out


def flight_extent(rehearsed: SimulatedFlight, vehicle: Vehicle) -> tuple[float, float, float]:
    """Return length, width and height of the space that a flight needs, hull included. [m]"""
    radius, half_height = vehicle_reach(vehicle)
    (x, y), top = np.ptp(rehearsed.path[:, :2], axis=0) + 2.0 * radius, rehearsed.path[:, 2].max()
    return float(x), float(y), float(top) + half_height
