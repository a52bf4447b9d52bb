"""Generate a case of the row 'rough': wrong vehicle files, and logs as laboratories have them."""

from collections.abc import Sequence
from typing import Any, Final, final

from lta_challenge.case import (
    CaseFlight,
    CaseGenerator,
    ChallengeCase,
    ChallengeVehicle,
    ROLES,
    vehicle_to_dict,
)
from lta_challenge.roughness import (
    add_spikes,
    cut_gaps,
    distort_vehicle_file,
    prepend_floor,
    prepend_hold,
)
from lta_challenge.rows import find_challenge_row
from lta_challenge.truth_sensors import Streams
from lta_discovery.model.nominal import NominalVehicle
import numpy as np

Draw = np.random.Generator

ROW: Final = 'rough'
LIFT: Final = 0.03  # N; deviation of a flight's lift
TRIM: Final = 0.2  # N; trim error of one case in ten
LONG: Final = (26.0, 40.0)  # s; range of flight lengths
SHORT: Final = (6.0, 11.0)  # s; the same for cases of short flights
SEVERAL: Final = (5, 7)  # training flights of such a case, at least and below
PART: Final = 900  # of the random generators, apart from those of ordinary cases


@final
class RoughCaseGenerator:
    """
    Generator of one rough case.

    `text`: its file. `seed`, `number`: seed of the challenge and number of the case.
    """

    def __init__(self, vehicle: ChallengeVehicle, text: str, seed: int, number: int) -> None:
        self._vehicle, self._text, self._number = vehicle, text, number
        self._root = [seed, number, find_challenge_row(ROW).code]
        draw = self._create_random_generator(0)
        self._short, self._pushed = draw.random() < 0.4, draw.random() < 0.5
        self._trim = TRIM * float(draw.choice([-1.0, 1.0])) if draw.random() < 0.1 else 0.0
        self._roles: Sequence[str] = ROLES
        if self._short:
            self._roles = (*ROLES, *['train'] * int(draw.integers(SEVERAL[0] - 1, SEVERAL[1] - 1)))
        self._flights = CaseGenerator(
            vehicle,
            seed,
            number,
            'wrench' if self._pushed else 'base',
            'clean',
            SHORT if self._short else LONG,
        )

    def _create_random_generator(self, part: int) -> Draw:
        return np.random.default_rng([*self._root, PART + part])

    def generate_case(self) -> ChallengeCase:
        """Generate the case."""
        text, factors = distort_vehicle_file(self._text, self._create_random_generator(1))
        case = self._flights.generate_case(self._roles, self._add_lift)
        flights, troubles = [], dict[str, list[str]]()
        for index, flight in enumerate(case.flights):
            streams, troubles[flight.name] = self._roughen(flight.streams, index)
            flights.append(CaseFlight(flight.name, flight.role, flight.course, streams))
        answer: dict[str, Any] = {
            **case.answer, 'row': ROW, 'factors': factors, 'troubles': troubles,
            'trim': self._trim, 'nominal': vehicle_to_dict(self._vehicle.nominal),
        }  # fmt: skip
        return ChallengeCase(self._number, tuple(flights), answer, text)

    def _add_lift(self, nominal: NominalVehicle, index: int) -> NominalVehicle:
        """Return the vehicle with the lift of one flight, which no file knows."""
        draw = self._create_random_generator(10 + index)
        more = self._trim + LIFT * float(draw.standard_normal())
        now = nominal.parameter_value('net_lift', 'force')
        return nominal.with_value('net_lift', 'force', now + more)

    def _roughen(self, streams: Streams, index: int) -> tuple[Streams, list[str]]:
        """Return the log of a flight with its troubles."""
        draw, troubles = self._create_random_generator(100 + index), []
        if not self._pushed and draw.random() < 0.5:
            # Only a tracker and the commands
            streams = {name: streams[name] for name in ('ground_truth/odom', 'motors')}
        if draw.random() < 0.5:
            streams = prepend_hold(streams, float(draw.uniform(1.0, 5.0)), draw)
            troubles.append('hold')
        elif draw.random() < 0.5:
            floor = self._vehicle.vehicle.hull_height_on_floor
            streams = prepend_floor(streams, float(draw.uniform(1.0, 4.0)), floor, draw)
            troubles.append('floor')
        if draw.random() < 0.6:
            streams = add_spikes(streams, int(draw.integers(1, 12)), draw)
            troubles.append('spikes')
        if draw.random() < 0.6:
            streams = cut_gaps(streams, int(draw.integers(1, 4)), draw)
            troubles.append('gaps')
        return streams, troubles
