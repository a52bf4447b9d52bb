"""Generate a case of a challenge; it depends on seed, number, row and kind only."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

from lta_challenge.course import plan_pilot_inputs
from lta_challenge.effect_injection import (
    choose_effects,
    choose_outside_kind,
    CLEAR,
    draw_outside_parameters,
    draw_structured_errors,
    FAINT,
    InjectedEffect,
    list_injectable_parameters,
    scale_unlisted_effect,
)
from lta_challenge.rows import find_challenge_row, Kind, KINDS
from lta_challenge.tolerance import apply_flight_errors, perturb_vehicle
from lta_challenge.truth_flight import TICK
from lta_challenge.truth_sensors import Instruments, Streams, TruthSensors
from lta_challenge.truth_simulation import simulate_flight, TruthTrajectory
from lta_challenge.truth_vehicle import build_truth_vehicle, TruthVehicle
from lta_discovery.fit.evidence import FLOOR
from lta_discovery.flights.bags import Role
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Draw = np.random.Generator
FlightChange = Callable[[NominalVehicle, int], NominalVehicle]

ROLES: Final[tuple[Role, ...]] = ('train', 'confirm', 'holdout')
LEARNED: Final = (0, 1)  # indices of the flights from which discovery learns
SECONDS: Final = (60.0, 180.0)  # s; range of flight lengths
TRIALS: Final = 4  # draws of an effect outside the library, and flights that scale each of them
TILT: Final = 0.05  # rad; standard deviation of the initial tilt


@final
@dataclass(frozen=True, slots=True)
class ChallengeVehicle:
    """The vehicle of a challenge, without hidden effects."""

    vehicle: Vehicle  # vehicle of the file
    nominal: NominalVehicle  # its parameters
    knobs: list[FreeParameter]  # parameters that can be hidden


@final
@dataclass(frozen=True, slots=True)
class CaseFlight:
    """A recorded flight of a case."""

    # Name of its bag; 'train', 'confirm' or 'holdout'; kind of course
    name: str
    role: str
    course: str
    streams: Streams  # recorded data


@final
@dataclass(frozen=True, slots=True)
class ChallengeCase:
    """A case."""

    number: int
    flights: tuple[CaseFlight, ...]
    answer: dict[str, Any]  # hidden until scoring
    # Text of the vehicle file that discovery gets; '' for the unchanged one
    vehicle_file: str = ''


@final
class CaseGenerator:
    """
    Generator of one case.

    Parameters
    ----------
    seed, number : int
        Seed of the challenge and number of the case.
    row_name : str
        Kind of flights, see `rows.ROWS`.
    kind : str, optional
        Kind of hidden effects; random by default.
    seconds : pair of float
        Range of flight lengths. [s]

    """

    def __init__(
        self,
        vehicle: ChallengeVehicle,
        seed: int,
        number: int,
        row_name: str = 'base',
        kind: Kind | None = None,
        seconds: tuple[float, float] = SECONDS,
    ) -> None:
        self._vehicle, self._row_name, self._row = vehicle, row_name, find_challenge_row(row_name)
        self._number, self._seconds = number, seconds
        # All random numbers of the case derive from these three numbers
        self._root = [seed, number, self._row.code]
        draw = self._create_random_generator(0)
        kinds, weights = list(KINDS), list(KINDS.values())
        self.kind: Kind = kind or kinds[int(draw.choice(len(kinds), p=weights))]

    def _create_random_generator(self, part: int) -> Draw:
        return np.random.default_rng([*self._root, part])

    def _draw_hidden_effects(self) -> tuple[InjectedEffect, ...]:
        """Draw the hidden effects of the library."""
        # Number of hidden effects of the library
        count = {'clean': 0, 'single': 1, 'pair': 2, 'outside': 0, 'mixed': 1}[self.kind]
        candidates = list_injectable_parameters(self._vehicle.knobs, self._row)
        return choose_effects(candidates, count, self._row, self._create_random_generator(1))

    def _build_case_vehicle(self, hidden: tuple[InjectedEffect, ...]) -> NominalVehicle:
        """Return the vehicle with the hidden effects and within-tolerance errors."""
        nominal, by_name = self._vehicle.nominal, {knob.name: knob for knob in self._vehicle.knobs}
        for one in hidden:
            nominal = by_name[one.knob].apply_to(nominal, one.value)
        return perturb_vehicle(nominal, self._row.worse, self._create_random_generator(2))

    def generate_case(
        self, roles: Sequence[str] = ROLES, change: FlightChange = lambda nominal, _index: nominal
    ) -> ChallengeCase:
        """
        Generate the case; the flight of a role does not depend on the roles that follow.

        `roles`: of the flights. `change`: changes the true vehicle of a flight, by its index.
        """
        hidden = self._draw_hidden_effects()
        nominal, outside, name = self._build_case_vehicle(hidden), dict[str, Any](), ''
        if self._row.structured:
            outside |= draw_structured_errors(self._create_random_generator(3))
        floors = 0.0
        if self.kind in ('outside', 'mixed'):
            # Scale the effect in the flights in which it will act
            name, values, floors = self._draw_detectable_effect(nominal, outside)
            outside[name] = values
        size = self._measure_outside_effect(nominal, outside, name) if name else 0.0
        flights = tuple(
            self._record_flight(change(nominal, index), outside, index, role)
            for index, role in enumerate(roles)
        )
        answer = {
            'kind': self.kind,
            'row': self._row_name,
            'hidden': [one._asdict() for one in hidden],
            'outside': name,
            'floors': floors,
            'size': size,
            'strange': outside,
            'courses': {flight.name: flight.course for flight in flights},
            'nominal': vehicle_to_dict(nominal),
        }
        return ChallengeCase(self._number, flights, answer)

    def _draw_detectable_effect(
        self, nominal: NominalVehicle, outside: dict[str, Any]
    ) -> tuple[str, dict[str, float], float]:
        """Draw a detectable effect outside the library: name, parameters, strength."""
        draw = self._create_random_generator(4)
        for _ in range(TRIALS):
            # Cases with odd numbers use the late kinds
            name = choose_outside_kind(draw, late=self._number % 2 == 1)
            values, floors = self._scale_outside_effect(nominal, outside, name, draw)
            if floors >= FAINT:
                break
        return name, values, floors

    def _scale_outside_effect(
        self, nominal: NominalVehicle, outside: dict[str, Any], name: str, draw: Draw
    ) -> tuple[dict[str, float], float]:
        """Scale an effect outside the library to a random strength; return it and its strength."""
        values = draw_outside_parameters(name, draw)
        aim = CLEAR[0] * (CLEAR[1] / CLEAR[0]) ** draw.random()
        reached = 0.0
        for trial in range(TRIALS + 1):
            happened = self._simulate_flight(nominal, {**outside, name: values}, 0)[0]
            # Subtract the model errors of the row 'structured', which are also in `strange`
            other = self._simulate_flight(nominal, outside, 0)[0].strange if outside else 0.0
            reached = wrench_strength(happened.strange - other)
            # Stop within 25 % of the intended strength; the response to the size may be nonlinear
            if trial == TRIALS or reached == 0.0 or 0.8 < reached / aim < 1.25:
                break
            # Limit the step: far from the solution, strength and size are not proportional
            values = scale_unlisted_effect(name, values, min(max(aim / reached, 0.05), 20.0))
        return values, reached

    def _measure_outside_effect(
        self, nominal: NominalVehicle, outside: dict[str, Any], name: str
    ) -> float:
        """Return the strength of an effect in the flights that discovery learns from."""
        rest = {each: values for each, values in outside.items() if each != name}
        both = [
            self._simulate_flight(nominal, outside, index)[0].strange
            - (self._simulate_flight(nominal, rest, index)[0].strange if rest else 0.0)
            for index in LEARNED
        ]
        return wrench_strength(*both)

    def _simulate_flight(
        self, nominal: NominalVehicle, outside: dict[str, Any], index: int
    ) -> tuple[TruthTrajectory, TruthVehicle, str, Draw]:
        """Simulate one flight; its generator goes on into the sensors."""
        # Parts 0 to 5 belong to the case; each flight has its own generator from 10 on
        draw = self._create_random_generator(10 + index)
        courses = self._row.courses
        # Flights of a case differ where they can.
        course = courses[
            (int(self._create_random_generator(5).integers(len(courses))) + index) % len(courses)
        ]
        seconds = float(draw.uniform(*self._seconds))
        hull = build_truth_vehicle(apply_flight_errors(nominal, self._row.worse, draw), outside)
        pilot = plan_pilot_inputs(course, round(seconds), self._row.pushed, draw)
        # Voltage at the start [V]; drop per duty and second [V/s]; drop per duty [V]
        cell = (draw.uniform(3.85, 4.15), 0.0008, 0.06)
        happened = simulate_flight(
            hull,
            pilot,
            self._vehicle.nominal,
            height=float(pilot.setpoints[0, 0]),
            tilt=(TILT * draw.standard_normal(3)).tolist(),
            cell=cell,
        )
        return happened, hull, course, draw

    def _record_flight(
        self, nominal: NominalVehicle, outside: dict[str, Any], index: int, role: str
    ) -> CaseFlight:
        """Simulate one flight and its sensors."""
        happened, hull, course, draw = self._simulate_flight(nominal, outside, index)
        kinds = Instruments().scale_noise(self._row.worse)
        seen = TruthSensors(
            happened, hull, self._vehicle.vehicle.file, kinds, draw
        ).record_streams()
        time = TICK * np.arange(len(happened.commands), dtype=np.float64)
        rotors = len(self._vehicle.nominal.rotors)
        streams = {name: seen[name] for name in self._row.topics}
        if self._row.pushed:
            streams['wrench_command'] = (time, happened.commands[:, :6])
        else:
            streams['motors'] = (time, happened.commands[:, :rotors])
        # Additional flights of a role get a number, so that bag names stay unique
        name = role if index < len(ROLES) else f'{role}_{index + 1}'
        return CaseFlight(name, role, course, streams)


def wrench_strength(*flights: Array) -> float:
    """
    Return the largest standard deviation of a wrench over its axes, in noise floors.

    Root mean square of flights, each of shape (n, 6).
    """
    # The variance ignores the mean, which trim and lift errors absorb
    variances = [np.var(forces, axis=0) for forces in flights]
    return float(np.max(np.sqrt(np.mean(variances, axis=0)) / FLOOR))


def vehicle_to_dict(nominal: NominalVehicle) -> dict[str, Any]:
    """Return a vehicle as JSON data."""
    return {
        'given': {name: dict(values) for name, values in nominal.effect_parameters.items()},
        'mass': nominal.mass,
        'displaced': nominal.displaced,
        'inertia': nominal.inertia.tolist(),
    }
