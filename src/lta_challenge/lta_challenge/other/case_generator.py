"""Draw a case of the row `other` from seed, number and kind alone."""

from collections.abc import Sequence
from dataclasses import replace
import math
from typing import Any, Final, final

from lta_challenge.case import CaseFlight, ChallengeCase, ROLES, SECONDS
from lta_challenge.other.air import MovingAir, RoomDraught, UnsteadyWind
from lta_challenge.other.effect_injection import draw_effects, inject_effects, true_values
from lta_challenge.other.flight import FlightSimulator, SimulatedPath
from lta_challenge.other.pilot import SwingingPilot
from lta_challenge.other.sensors import SensorSet, STAMPS, Stamps
from lta_challenge.other.sizing import draw_unlisted, scale_unlisted, wrench_strength
from lta_challenge.other.tolerance import perturb_flight, perturb_vehicle
from lta_challenge.other.truth import build_truth, VehicleTruth
from lta_challenge.other.unlisted import UNLISTED
from lta_challenge.rows import Kind, KINDS
from lta_model.vehicle import Vehicle
import numpy as np

Draw = np.random.Generator

CODE: Final = 6  # of the row
DRAUGHTY: Final = 0.25  # of the clean cases
DRAUGHT: Final = (1e-3, 3e-3)  # m/s
TILT: Final = 0.03  # rad; at the start
SPEED: Final = 0.01  # m/s; at the start
START: Final = (1.2, 1.7)  # m; of the height
SIZES: Final = (2.0, 40.0)  # floors; of what is in no library
TRIALS: Final = 4  # flights that size it, and times that it is drawn
COURSE: Final = 'swinging'


@final
class OtherCaseGenerator:
    """
    Draws one case.

    Parameters
    ----------
    vehicle : Vehicle
        As its file has it.
    seed, number : int
        Of the challenge and the case.
    kind : str, optional
        What is hidden; drawn where nobody asks for one.
    seconds : pair of float
        Between which the lengths of the flights are. [s]

    """

    def __init__(
        self,
        vehicle: Vehicle,
        seed: int,
        number: int,
        kind: Kind | None = None,
        seconds: tuple[float, float] = SECONDS,
    ) -> None:
        self._file, self._number, self._seconds = build_truth(vehicle), number, seconds
        self._root = [seed, number, CODE]
        kinds, weights = list(KINDS), list(KINDS.values())
        drawn = kinds[int(self._make_generator(0).choice(len(kinds), p=weights))]
        self.kind: Kind = kind or drawn

    def _make_generator(self, part: int) -> Draw:
        """Return where the chance of one part of the case comes from."""
        return np.random.default_rng([*self._root, part])

    def generate_case(self, roles: Sequence[str] = ROLES) -> ChallengeCase:
        """Draw it, and fly all its flights."""
        count = {'clean': 0, 'single': 1, 'pair': 2, 'outside': 0, 'mixed': 1}[self.kind]
        hidden = draw_effects(count, self._make_generator(1))
        truth = inject_effects(perturb_vehicle(self._file, self._make_generator(2)), hidden)
        stamps, draught = self._draw_conditions()
        truth = replace(truth, draught=draught)
        name, numbers, floors = '', dict[str, float](), 0.0
        if self.kind in ('outside', 'mixed'):
            name, numbers, floors = self._draw_sized_unlisted(truth)
        flights = tuple(
            self._record_flight(truth, index, role, stamps, name, numbers)
            for index, role in enumerate(roles)
        )
        answer = {
            'kind': self.kind,
            'row': 'other',
            'hidden': [{'knob': knob, 'value': value} for knob, value in hidden.items()],
            'outside': name,
            'floors': floors,
            'strange': {name: numbers} if name else {},
            'courses': {flight.name: flight.course for flight in flights},
            'nominal': self._truth_to_dict(truth, hidden),
            'stamps': stamps,
            'draught': draught,
        }
        return ChallengeCase(self._number, flights, answer)

    def _truth_to_dict(self, truth: VehicleTruth, hidden: dict[str, float]) -> dict[str, Any]:
        """Return a vehicle as plain data."""
        return {
            'given': true_values(truth, self._file, hidden),
            'mass': truth.mass,
            'displaced': truth.displaced,
            'inertia': np.diag(truth.inertia).tolist(),
        }

    def _draw_conditions(self) -> tuple[Stamps, float]:
        """Return how times are written down, and how much the air moves by itself. [m/s]."""
        draw = self._make_generator(3)
        stamps = STAMPS[int(draw.integers(len(STAMPS)))]
        draughty, size = draw.random() < DRAUGHTY, float(draw.uniform(*DRAUGHT))
        return stamps, size if draughty and self.kind == 'clean' else 0.0

    def _draw_sized_unlisted(self, truth: VehicleTruth) -> tuple[str, dict[str, float], float]:
        """Return what is in no library, drawn and scaled until a flight shows it well."""
        draw = self._make_generator(4)
        best: tuple[str, dict[str, float], float] = ('', {}, 0.0)
        for _ in range(TRIALS):
            name, numbers = draw_unlisted(draw)
            aim = SIZES[0] * (SIZES[1] / SIZES[0]) ** draw.random()
            for _ in range(TRIALS):
                floors = wrench_strength(
                    self._simulate_flight(truth, 0, name, numbers)[0].unlisted
                )
                if floors > best[2] or name == best[0]:
                    best = name, numbers, floors
                if floors == 0.0 or 0.8 < floors / aim < 1.25:
                    break
                numbers = scale_unlisted(name, numbers, min(max(aim / floors, 0.1), 10.0))
            if SIZES[0] <= best[2] <= 1.25 * SIZES[1]:
                break
        return best

    def _simulate_flight(
        self, truth: VehicleTruth, index: int, name: str, numbers: dict[str, float]
    ) -> tuple[SimulatedPath, VehicleTruth, Draw]:
        """Fly one flight; its chance goes on into the sensors."""
        draw = self._make_generator(10 + index)
        seconds = float(round(draw.uniform(*self._seconds)))
        truth = perturb_flight(truth, draw)
        air: list[MovingAir] = []
        if any(truth.wind):
            air.append(UnsteadyWind(truth, seconds, draw))
        if truth.draught:
            air.append(RoomDraught(truth.draught, seconds, draw))
        pilot = SwingingPilot(seconds, self._file, draw)
        begin = _draw_initial_state(pilot.heading, draw)
        unlisted = UNLISTED[name].make(numbers) if name else None
        return FlightSimulator(truth, pilot, air, unlisted).simulate(begin, seconds), truth, draw

    def _record_flight(
        self,
        truth: VehicleTruth,
        index: int,
        role: str,
        stamps: Stamps,
        name: str,
        numbers: dict[str, float],
    ) -> CaseFlight:
        """Fly and watch one flight."""
        path, truth, draw = self._simulate_flight(truth, index, name, numbers)
        streams = SensorSet(path, truth, stamps, draw).record_streams()
        bag = role if index < len(ROLES) else f'{role}_{index + 1}'
        return CaseFlight(bag, role, COURSE, streams)


def _draw_initial_state(heading: float, draw: Draw) -> list[float]:
    """Return a state near rest, nearly upright."""
    nod, bank = (0.5 * TILT * float(each) for each in draw.standard_normal(2))
    c, s = math.cos(0.5 * heading), math.sin(0.5 * heading)
    turn = [c, c * bank - s * nod, c * nod + s * bank, s]
    length = math.sqrt(sum(each * each for each in turn))
    place = [*(0.3 * draw.standard_normal(2)).tolist(), float(draw.uniform(*START))]
    velocity, rates = (SPEED * draw.standard_normal(6)).reshape(2, 3).tolist()
    return [*place, *velocity, *(each / length for each in turn), *rates]
