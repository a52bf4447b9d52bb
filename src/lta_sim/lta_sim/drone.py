# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
One drone of the simulator: its world, the command that it obeys, and its state for others.

With the parameters of the simulator, and the pace that it keeps.
"""

import operator
import time
from typing import final

from lta_config.errors import unknown_name_error
from lta_config.settings import setting, Settings
from lta_config.topics import TopicTable
from lta_graph.health import Health, HealthLevel
from lta_model.scenario import LARGEST_OFFSET, load_scenario, offset_start
from lta_model.vehicle import load_vehicle
from lta_sim.readings import FlightOutcome, SensorReadings
from lta_sim.world import World

LARGEST_CATCH_UP = 50  # control periods of delay that are caught up
# Control periods that are caught up without a pause: fewer than the queue of a sensor topic holds,
# as readers in the same process are called only afterwards
BURST_STEPS = 4
LOST_TIME_SHARE = 0.05  # share of the wall clock that may be lost before a report


@final
class Pacer:
    """
    Tell how many control steps are due: catch up after a short delay, and skip a long one.

    `period`: the control period [s].

    Attributes
    ----------
    began : float
        Wall time of the first step; 0 before. [s]
    lost : float
        Wall time of skipped delays. [s]

    """

    def __init__(self, period: float) -> None:
        self.lost = 0.0
        self.period = period
        self.began = self._anchor = 0.0

    def begin(self) -> None:
        """Begin to count now."""
        self.began = self._anchor = time.monotonic()

    @property
    def is_slow(self) -> bool:
        """Whether a noticeable part of the wall time is lost."""
        return self.lost > LOST_TIME_SHARE * (time.monotonic() - self.began)

    def count_due(self, steps: int) -> int:
        """Return how many steps to fly now, after so many."""
        due = round((time.monotonic() - self._anchor) / self.period) - steps
        if due > LARGEST_CATCH_UP:
            self._anchor += (due - 1) * self.period
            self.lost += (due - 1) * self.period
            return 1
        return min(due, BURST_STEPS)


WAIT_FOR_DEFAULT = 'default'  # value of `wait_for`
DESCRIPTION = 'description'  # another: a role that reads nothing of the simulator's


class DroneSettings(Settings):
    """One drone and its flight."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    scenario: str = setting('lamp_room', fixed=True)
    """Scenario name or file."""
    seed: int = setting(1, low=0, high=2**31 - 1, fixed=True)
    """Random seed."""
    strategy: str = setting('', fixed=True)
    """
    Navigation strategy. The power of its sensors and its computation is simulated. Empty: none.
    """
    offset_x: float = setting(0.0, 'm', -LARGEST_OFFSET, LARGEST_OFFSET, fixed=True)
    """Offset of the start position along x (east) from that of the scenario."""
    offset_y: float = setting(0.0, 'm', -LARGEST_OFFSET, LARGEST_OFFSET, fixed=True)
    """Offset of the start position along y (north) from that of the scenario."""
    commanded: bool = setting(False, fixed=True)
    """
    Whether the flight is commanded by actions: then neither a reached lamp nor the time limit of
    the scenario ends it.
    """


class SimulatorSettings(DroneSettings):
    """Parameters of the simulator node."""

    robots: str = setting('', fixed=True)
    """
    Namespaces of the drones, separated by spaces; empty for one, in that of the simulator. With
    several, parameters such as lta2.seed are those of each drone.
    """
    wait_for: str = setting(WAIT_FOR_DEFAULT, fixed=True)
    """
    Nodes to wait for before the flight starts, by their roles in the topic table and separated by
    spaces; empty: none. "default": in lockstep every node that reads an output of the simulator by
    the topic table, in real time none. "description": the publishers of URDF, scene and fixed
    frames.
    """
    record: bool = setting(False, fixed=True)
    """Whether the simulator waits for a recorder before it starts the flight."""
    topics: str = setting('', fixed=True)
    """Topics that the recorder records; must equal the setting of the recorder."""

    def list_awaited_roles(self, table: TopicTable, *, lockstep: bool) -> set[str]:
        """Return the roles to wait for; raise `BadInput` for an unknown one."""
        names = set(self.wait_for.split())
        roles = [WAIT_FOR_DEFAULT, DESCRIPTION, *table.roles]
        for name in sorted(names.difference(roles)):
            raise unknown_name_error('role in wait_for', name, roles)
        if WAIT_FOR_DEFAULT in names and lockstep:
            outputs = table.published_by('vehicle')
            names.update(role for name in outputs for role in table[name].subscribers)
        return names - {WAIT_FOR_DEFAULT}


STALE_NS = 300_000_000  # commands older or newer than this stop the motors, as on the real vehicle
STANDING_HEIGHT = 0.03  # m above the standing height that still counts as on the ground
REPORTED_CHARACTERS = 100  # characters of a refused command that are reported


@final
class SimulatedDrone:
    """
    A `World` that obeys motor commands and reports on its flight.

    Attributes
    ----------
    world : World
        The drone in its scene.
    readings : SensorReadings
        Those of the present step.
    is_answered : bool
        Whether the command for the present step has come.

    """

    def __init__(self, settings: DroneSettings, table: TopicTable, health: Health) -> None:
        offset = settings.offset_x, settings.offset_y
        scenario = offset_start(load_scenario(settings.scenario), *offset)
        vehicle = load_vehicle(settings.vehicle, scenario.air.density)
        self.world = World(vehicle, scenario, table, settings.seed, settings.strategy)
        if settings.commanded:
            self.world.fly_without_end()
        self.readings = SensorReadings(self.world.stamp_ns)
        self.is_answered = False
        self._table = table
        self._health = health
        self._rotors = vehicle.rotor_names
        self._lowest = [-1.0 if reversible else 0.0 for reversible in vehicle.reversible]
        self._duties = [0.0] * len(self._rotors)
        self._commanded_ns = 0
        self._refused = False
        self._fed = True
        self._finished: float | None = None
        self._is_commanded = settings.commanded
        self._has_flown = False

    @property
    def duties(self) -> list[float]:
        """Return the duties that it obeys, by rotor."""
        return self._duties

    @property
    def is_over(self) -> bool:
        """Whether to stop: one control step after a light block, when all have answered."""
        over = self.world.outcome is not FlightOutcome.FLYING
        return over and self._table.is_settled(self.world.stamp_ns)

    def finish(self) -> None:
        """End the flight; the drone stands still from now on."""
        self._finished = time.monotonic()

    def take_command(self, names: list[str], duties: list[float], stamp_ns: int) -> None:
        """Obey a motor command, or stop the motors on an invalid one."""
        # A future stamp would stay fresh for too long
        if stamp_ns <= self.world.stamp_ns + STALE_NS:
            self._commanded_ns = stamp_ns
        fits = names == self._rotors and len(duties) == len(self._rotors)
        # NaN is refused as well: it compares false
        if fits and all(map(operator.le, self._lowest, duties)) and max(duties) <= 1.0:
            self._duties = duties
            if self._refused:
                self._refused = False
                self._health.report('command', HealthLevel.OK, 'accepted')
            return
        # An invalid command must not leave the last one active
        self._duties = [0.0] * len(self._rotors)
        self._refused = True
        self._health.report(
            'command',
            HealthLevel.ERROR,
            f'invalid motor command with the duties {repr(duties)[:REPORTED_CHARACTERS]} for the '
            f'rotors {repr(names)[:REPORTED_CHARACTERS]}, so the motors are off; send duties for '
            f'the rotors {self._rotors}, from {self._lowest} to 1',
        )

    def stop_without_command(self) -> None:
        """Stop the motors if the last command is old, as on the real vehicle."""
        if self.world.stamp_ns - self._commanded_ns > STALE_NS:
            self._duties = [0.0] * len(self._duties)

    def advance(self) -> None:
        """Fly one control period, and report a failure of the supply and its end."""
        self.is_answered = False
        self.world.advance(self._duties)
        if self._fed == self.world.supply.is_fed:
            return
        self._fed = not self._fed
        if self._fed:
            self._health.report(
                'supply',
                HealthLevel.OK,
                'the solar panel has charged the battery: the power supply is on again',
            )
        else:
            self._health.report(
                'supply',
                HealthLevel.ERROR,
                'brown-out: the battery is empty or its voltage fell below the cut-off; '
                'the motors are off until light has charged it',
            )

    @property
    def _stands(self) -> bool:
        """Whether it is on the ground."""
        floor = self.world.vehicle.hull_height_on_floor
        return bool(self.world.state[2] < floor + STANDING_HEIGHT)

    @property
    def _is_landed(self) -> bool:
        """Whether commands have ended its flight on the ground."""
        return (
            self._finished is not None
            and self._is_commanded
            and self._has_flown
            and self.world.outcome is FlightOutcome.FLYING
            and not any(self._duties)
            and self._stands
        )

    def report_flight(self, pacer: Pacer) -> dict[str, str]:
        """Report and return the state of the flight, which a pacer has kept to the wall clock."""
        world = self.world
        self._has_flown |= not self._stands
        wall = (self._finished or time.monotonic()) - pacer.began if pacer.began else 0.0
        # Simulated seconds per wall second
        pace = world.elapsed / wall if wall else 0.0
        state = {
            'outcome': 'landed' if self._is_landed else world.outcome.name.lower(),
            'sentence': 'on the ground' if self._is_landed else str(world.outcome),
            'time_s': f'{world.elapsed:.2f}',
            'distance_m': f'{world.goal_distance:.3f}',
            'pace': f'{pace:.2f}',
            'lost_s': f'{pacer.lost:.2f}',
        }
        text = f'{state["sentence"]}, {state["distance_m"]} m from the lamp'
        self._health.report('flight', HealthLevel.OK, text, **state)
        return state
