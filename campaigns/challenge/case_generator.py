# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Generate a case; it depends on seed, number and kind only."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import math
from typing import Any, Final, final, Literal

from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

from campaigns.challenge.air import MovingAir, RoomAirMotion, UnsteadyWind
from campaigns.challenge.effect_injection import draw_hidden_effects, inject_effects, true_values
from campaigns.challenge.flight import FlightSimulator, SimulatedTrajectory, TICK
from campaigns.challenge.pilot import SwingingPilot
from campaigns.challenge.sensors import SensorSet, STAMPS, Stamps
from campaigns.challenge.tolerance import apply_flight_errors, perturb_vehicle
from campaigns.challenge.truth import build_vehicle_truth, VehicleTruth
from campaigns.challenge.unlisted import draw_unlisted, scale_unlisted, UNLISTED, wrench_strength
from campaigns.challenge.wrench_flight import WrenchActuators, WrenchPilot

Array = NDArray[np.float64]
Streams = Mapping[str, tuple[Array, Array]]  # times [s] and values by topic
Kind = Literal['clean', 'single', 'pair', 'outside', 'mixed', 'wrench', 'rough']

# Probabilities of what is hidden, if none is requested. Of 'wrench' and 'rough', see `COUNTS`
KINDS: Final[dict[Kind, float]] = {
    'clean': 0.3, 'single': 0.25, 'pair': 0.15, 'outside': 0.15, 'mixed': 0.15,
    'wrench': 0.0, 'rough': 0.0,
}  # fmt: skip
# Effects of the library that are hidden. 'wrench': of a vehicle whose log has its pose and the
# wrench that it is told to apply. 'rough': with a tracker that loses and misplaces it
COUNTS: Final[dict[Kind, int]] = {
    'clean': 0, 'single': 1, 'pair': 2, 'outside': 0, 'mixed': 1, 'wrench': 1, 'rough': 1,
}  # fmt: skip
ROLES: Final = ('train', 'confirm', 'holdout')
LEARNED: Final = (0, 1)  # indices of the flights from which discovery learns
SECONDS: Final = (60.0, 180.0)  # s; range of flight lengths


@final
@dataclass(frozen=True, slots=True)
class CaseFlight:
    """A recorded flight of a case."""

    name: str  # of its bag
    role: str  # 'train', 'confirm' or 'holdout'
    streams: Streams


@final
@dataclass(frozen=True, slots=True)
class ChallengeCase:
    """A case."""

    number: int
    flights: tuple[CaseFlight, ...]
    answer: dict[str, Any]


Draw = np.random.Generator

CODE: Final = 6  # part of the random seed
DRAUGHTY: Final = 0.25  # share of the clean cases that have a draught
DRAUGHT: Final = (1e-3, 3e-3)  # m/s; range of its rms
TILT: Final = 0.03  # rad; initial tilt
SPEED: Final = 0.01  # m/s and rad/s; initial velocity and rates
START: Final = (1.2, 1.7)  # m; range of the initial height
THINNED: Final = 3  # one pose of so many is recorded by a rough tracker
MISPLACED: Final = 0.003  # share of the poses
MISPLACEMENT: Final = (0.2, 1.0)  # m; range, on each axis
LOSSES: Final = 4  # gaps in a flight
LOST: Final = (0.3, 1.5)  # s; range of their length
SIZES: Final = (2.0, 40.0)  # noise floors; strength of an effect outside the library
TRIALS: Final = 4  # draws of such an effect, and flights that scale each of them


@final
class OtherCaseGenerator:
    """
    Generator of one case.

    Parameters
    ----------
    vehicle : Vehicle
        Vehicle of the file.
    seed, number : int
        Seed of the challenge and number of the case.
    kind : str, optional
        Kind of hidden effects; random by default.
    seconds : pair of float
        Range of flight lengths. [s]

    """

    def __init__(
        self,
        vehicle: Vehicle,
        seed: int,
        number: int,
        kind: Kind | None = None,
        seconds: tuple[float, float] = SECONDS,
    ) -> None:
        self._file, self._number, self._seconds = build_vehicle_truth(vehicle), number, seconds
        self._root = [seed, number, CODE]
        kinds, weights = list(KINDS), list(KINDS.values())

        random_kind = kinds[int(self._create_random_generator(0).choice(len(kinds), p=weights))]
        self.kind: Kind = kind or random_kind

    def _create_random_generator(self, part: int) -> Draw:
        return np.random.default_rng([*self._root, part])

    def generate_case(self, roles: Sequence[str] = ROLES) -> ChallengeCase:
        """Generate the case with one flight per role."""
        hidden = draw_hidden_effects(
            COUNTS[self.kind], self._create_random_generator(1), self.kind == 'wrench'
        )
        truth = inject_effects(
            perturb_vehicle(self._file, self._create_random_generator(2)), hidden
        )
        stamps, draught = self._draw_conditions()
        truth = replace(truth, draught=draught)
        name, numbers, size = '', dict[str, float](), 0.0
        if self.kind in ('outside', 'mixed'):
            name, numbers = self._draw_detectable_disturbance(truth)
            both = [self._simulate_flight(truth, index, name, numbers)[0] for index in LEARNED]
            size = wrench_strength(*(path.unlisted for path in both))
        flights = tuple(
            self._record_flight(truth, index, role, stamps, name, numbers)
            for index, role in enumerate(roles)
        )
        answer = {
            'kind': self.kind,
            'hidden': [{'knob': knob, 'value': value} for knob, value in hidden.items()],
            'outside': name,
            'size': size,
            'nominal': self._truth_to_dict(truth, hidden),
        }
        return ChallengeCase(self._number, flights, answer)

    def _truth_to_dict(self, truth: VehicleTruth, hidden: dict[str, float]) -> dict[str, Any]:
        """Return a vehicle as JSON data."""
        return {
            'given': true_values(truth, self._file, hidden),
            'mass': truth.mass,
            'displaced': truth.displaced,
            'inertia': np.diag(truth.inertia).tolist(),
        }

    def _draw_conditions(self) -> tuple[Stamps, float]:
        """Draw the mode of the stamps and the draught [m/s]."""
        draw = self._create_random_generator(3)
        stamps = STAMPS[int(draw.integers(len(STAMPS)))]
        draughty, size = draw.random() < DRAUGHTY, float(draw.uniform(*DRAUGHT))
        # A draught is not a hidden effect: clean cases test whether it causes a wrong name
        return stamps, size if draughty and self.kind == 'clean' else 0.0

    def _draw_detectable_disturbance(self, truth: VehicleTruth) -> tuple[str, dict[str, float]]:
        """Draw and scale an effect outside the library until a flight shows it clearly."""
        draw = self._create_random_generator(4)
        best: tuple[str, dict[str, float], float] = ('', {}, 0.0)
        for _ in range(TRIALS):
            name, numbers = draw_unlisted(draw)
            aim = SIZES[0] * (SIZES[1] / SIZES[0]) ** draw.random()
            for _ in range(TRIALS):
                floors = wrench_strength(
                    self._simulate_flight(truth, 0, name, numbers)[0].unlisted
                )
                # Keep the strongest kind so far, and its latest scaling
                if floors > best[2] or name == best[0]:
                    best = name, numbers, floors
                if floors == 0.0 or 0.8 < floors / aim < 1.25:
                    break
                numbers = scale_unlisted(name, numbers, min(max(aim / floors, 0.1), 10.0))
            if SIZES[0] <= best[2] <= 1.25 * SIZES[1]:
                break
        return best[:2]

    def _simulate_flight(
        self, truth: VehicleTruth, index: int, name: str, numbers: dict[str, float]
    ) -> tuple[SimulatedTrajectory, VehicleTruth, Draw]:
        """Simulate one flight; its generator goes on into the sensors."""
        draw = self._create_random_generator(10 + index)
        seconds = float(round(draw.uniform(*self._seconds)))
        truth = apply_flight_errors(truth, draw)
        air: list[MovingAir] = []
        if any(truth.wind):
            air.append(UnsteadyWind(truth, seconds, draw))
        if truth.draught:
            air.append(RoomAirMotion(truth.draught, seconds, draw))
        if self.kind == 'wrench':
            begin = draw_initial_state(float(draw.uniform(-math.pi, math.pi)), draw)
            operator = WrenchPilot(self._file, truth.wrench_gains, draw)
            simulator = FlightSimulator(truth, operator, air, None, WrenchActuators)
        else:
            pilot = SwingingPilot(seconds, self._file, draw)
            begin = draw_initial_state(pilot.heading, draw)
            unlisted = UNLISTED[name].make(numbers) if name else None
            simulator = FlightSimulator(truth, pilot, air, unlisted)
        return simulator.simulate_flight(begin, seconds), truth, draw

    def _record_flight(
        self,
        truth: VehicleTruth,
        index: int,
        role: str,
        stamps: Stamps,
        name: str,
        numbers: dict[str, float],
    ) -> CaseFlight:
        """Simulate one flight and its sensors."""
        path, truth, draw = self._simulate_flight(truth, index, name, numbers)
        sensors = SensorSet(path, truth, stamps, draw)
        bag = role if index < len(ROLES) else f'{role}_{index + 1}'
        if self.kind == 'wrench':
            time = TICK * np.arange(len(path.commands), dtype=np.float64)
            poses = sensors.measure_poses()
            commands = (time, path.commands)
            streams: Streams = {'ground_truth/odom': poses, 'wrench_command': commands}
        else:
            streams = sensors.record_streams()
        if self.kind == 'rough':
            rough = roughen_poses(*streams['ground_truth/odom'], draw)
            streams = {**streams, 'ground_truth/odom': rough}
        return CaseFlight(bag, role, streams)


def roughen_poses(time: Array, poses: Array, draw: Draw) -> tuple[Array, Array]:
    """Return the poses of a tracker that is slow, loses the vehicle and misplaces it at times."""
    poses, kept = poses.copy(), np.zeros(len(time), dtype=bool)
    kept[::THINNED] = True
    wrong = np.flatnonzero(draw.random(len(time)) < MISPLACED)
    poses[wrong, :3] += draw.uniform(*MISPLACEMENT) * draw.choice([-1.0, 1.0], (len(wrong), 3))
    for begin in draw.uniform(time[0], time[-1], LOSSES):
        kept &= (time < begin) | (time > begin + draw.uniform(*LOST))
    return time[kept], poses[kept]


def draw_initial_state(heading: float, draw: Draw) -> list[float]:
    """Draw a state near rest and nearly upright."""
    nod, bank = (0.5 * TILT * float(each) for each in draw.standard_normal(2))
    c, s = math.cos(0.5 * heading), math.sin(0.5 * heading)
    # Product of the heading quaternion and a small rotation (nod and bank are half angles)
    turn = [c, c * bank - s * nod, c * nod + s * bank, s]
    length = math.sqrt(sum(each * each for each in turn))
    place = [*(0.3 * draw.standard_normal(2)).tolist(), float(draw.uniform(*START))]
    velocity, rates = (SPEED * draw.standard_normal(6)).reshape(2, 3).tolist()
    return [*place, *velocity, *(each / length for each in turn), *rates]
