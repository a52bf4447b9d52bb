"""Draw one case of a challenge from its seed and number alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

from lta_challenge.course import plan_pilot_inputs
from lta_challenge.effect_injection import (
    choose_effects,
    choose_outside,
    CLEAR,
    draw_outside,
    draw_structured,
    FAINT,
    InjectedEffect,
    list_candidates,
    scale_outside,
)
from lta_challenge.rows import find_row, Kind, KINDS
from lta_challenge.tolerance import perturb_flight, perturb_vehicle
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

ROLES: Final[tuple[Role, ...]] = ('train', 'confirm', 'holdout')
SECONDS: Final = (60.0, 180.0)  # of a flight
TRIALS: Final = 4  # flights that size what is outside the library, and times that it is drawn
TILT: Final = 0.05  # rad; a flight begins askew by


@final
@dataclass(frozen=True, slots=True)
class ChallengeVehicle:
    """
    What everybody knows.

    Attributes
    ----------
    vehicle : Vehicle
        As its file has it.
    nominal : Nominal
        Its numbers.
    knobs : list of Knob
        What can be turned about it.

    """

    vehicle: Vehicle
    nominal: NominalVehicle
    knobs: list[FreeParameter]


@final
@dataclass(frozen=True, slots=True)
class CaseFlight:
    """
    One flight.

    Attributes
    ----------
    name, role, course : str
        Of its bag; what it is for; what is flown.
    streams : mapping of topic to (times, values)
        What is recorded.

    """

    name: str
    role: str
    course: str
    streams: Streams


@final
@dataclass(frozen=True, slots=True)
class ChallengeCase:
    """
    One case.

    Attributes
    ----------
    number : int
        Of it.
    flights : tuple of Flight
        What is given.
    answer : dict
        What is sealed.

    """

    number: int
    flights: tuple[CaseFlight, ...]
    answer: dict[str, Any]


@final
class CaseGenerator:
    """
    Draws one case.

    Parameters
    ----------
    vehicle : ChallengeVehicle
        The vehicle.
    seed, number : int
        Of the challenge and the case; nothing else is drawn from.
    row_name : str
        What its flights are like.
    kind : str, optional
        What is hidden; drawn where nobody asks for one.
    seconds : pair of float
        Between which the lengths of the flights are. [s]

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
        self._vehicle, self._row_name, self._row = vehicle, row_name, find_row(row_name)
        self._number, self._seconds = number, seconds
        self._root = [seed, number, self._row.code]
        draw = self._make_generator(0)
        kinds, weights = list(KINDS), list(KINDS.values())
        self.kind: Kind = kind or kinds[int(draw.choice(len(kinds), p=weights))]

    def _make_generator(self, part: int) -> Draw:
        """Return where the chance of one part of the case comes from."""
        return np.random.default_rng([*self._root, part])

    def _draw_hidden(self) -> tuple[InjectedEffect, ...]:
        """Return what is hidden of the library."""
        count = {'clean': 0, 'single': 1, 'pair': 2, 'outside': 0, 'mixed': 1}[self.kind]
        candidates = list_candidates(self._vehicle.knobs, self._row)
        return choose_effects(candidates, count, self._row, self._make_generator(1))

    def _build_nominal(self, hidden: tuple[InjectedEffect, ...]) -> NominalVehicle:
        """Return the vehicle with what is hidden, and off as vehicles are."""
        nominal, by_name = self._vehicle.nominal, {knob.name: knob for knob in self._vehicle.knobs}
        for one in hidden:
            nominal = by_name[one.knob].apply_to(nominal, one.value)
        return perturb_vehicle(nominal, self._row.worse, self._make_generator(2))

    def generate_case(self, roles: Sequence[str] = ROLES) -> ChallengeCase:
        """Draw it, and fly all its flights: one for each role, the same whatever follows it."""
        hidden = self._draw_hidden()
        nominal, outside, name = self._build_nominal(hidden), dict[str, Any](), ''
        if self._row.structured:
            outside |= draw_structured(self._make_generator(3))
        floors = 0.0
        if self.kind in ('outside', 'mixed'):
            name, given, floors = self._draw_clear_outside(nominal, outside)
            outside[name] = given
        flights = tuple(
            self._record_flight(nominal, outside, index, role) for index, role in enumerate(roles)
        )
        answer = {
            'kind': self.kind,
            'row': self._row_name,
            'hidden': [one._asdict() for one in hidden],
            'outside': name,
            'floors': floors,
            'strange': outside,
            'courses': {flight.name: flight.course for flight in flights},
            'nominal': nominal_to_dict(nominal),
        }
        return ChallengeCase(self._number, flights, answer)

    def _draw_clear_outside(
        self, nominal: NominalVehicle, outside: dict[str, Any]
    ) -> tuple[str, dict[str, float], float]:
        """Return what is outside the library, drawn until the flights show anything of it."""
        draw = self._make_generator(4)
        for _ in range(TRIALS):
            name = choose_outside(draw, late=self._number % 2 == 1)
            given, floors = self._size_outside(nominal, outside, name, draw)
            if floors >= FAINT:
                break
        return name, given, floors

    def _size_outside(
        self, nominal: NominalVehicle, outside: dict[str, Any], name: str, draw: Draw
    ) -> tuple[dict[str, float], float]:
        """Return what is outside the library at a drawn strength, and what that came to."""
        given = draw_outside(name, draw)
        aim = CLEAR[0] * (CLEAR[1] / CLEAR[0]) ** draw.random()
        reached = 0.0
        for trial in range(TRIALS + 1):
            happened = self._simulate_flight(nominal, {**outside, name: given}, 0)[0]
            other = self._simulate_flight(nominal, outside, 0)[0].strange if outside else 0.0
            reached = wrench_strength(happened.strange - other)
            if trial == TRIALS or reached == 0.0 or 0.8 < reached / aim < 1.25:
                break
            given = scale_outside(name, given, min(max(aim / reached, 0.05), 20.0))
        return given, reached

    def _simulate_flight(
        self, nominal: NominalVehicle, outside: dict[str, Any], index: int
    ) -> tuple[TruthTrajectory, TruthVehicle, str, Draw]:
        """Fly one flight."""
        draw = self._make_generator(10 + index)
        courses = self._row.courses
        # Flights of a case differ where they can.
        course = courses[
            (int(self._make_generator(5).integers(len(courses))) + index) % len(courses)
        ]
        seconds = float(draw.uniform(*self._seconds))
        hull = build_truth_vehicle(perturb_flight(nominal, self._row.worse, draw), outside)
        pilot = plan_pilot_inputs(course, round(seconds), self._row.pushed, draw)
        cell = (draw.uniform(3.85, 4.15), 0.0008, 0.06)
        happened = simulate_flight(
            hull,
            pilot,
            self._vehicle.nominal,
            height=float(pilot.wanted[0, 0]),
            tilt=(TILT * draw.standard_normal(3)).tolist(),
            cell=cell,
        )
        return happened, hull, course, draw

    def _record_flight(
        self, nominal: NominalVehicle, outside: dict[str, Any], index: int, role: str
    ) -> CaseFlight:
        """Fly and watch one flight."""
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
        name = role if index < len(ROLES) else f'{role}_{index + 1}'
        return CaseFlight(name, role, course, streams)


def wrench_strength(forces: Array) -> float:
    """Return how many floors an unexplained wrench comes to on its strongest axis, mean apart."""
    return float(np.max(np.std(forces, axis=0) / FLOOR))


def nominal_to_dict(nominal: NominalVehicle) -> dict[str, Any]:
    """Return a vehicle as plain data."""
    return {
        'given': {name: dict(values) for name, values in nominal.given.items()},
        'mass': nominal.mass,
        'displaced': nominal.displaced,
        'inertia': nominal.inertia.tolist(),
    }
