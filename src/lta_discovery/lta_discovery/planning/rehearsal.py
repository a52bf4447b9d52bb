"""
A flight that is only thought of: flown in process, and what a recording would have of it.

The pilot knows the vehicle by one file and flies what may be another; a tracker of passive markers
sees the pose.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, final, Literal

from lta_config.topics import topic_table
from lta_discovery.flights.measured import measured, Stream, Streams
from lta_discovery.flights.windows import windows
from lta_discovery.model.knobs import Knob
from lta_discovery.model.nominal import Nominal
from lta_discovery.model.rotations import exponential, product
from lta_discovery.replay.linearise import Linearised
from lta_discovery.replay.periods import knots_for
from lta_discovery.replay.replay import Replay
from lta_discovery.replay.sensing import floor_pressure, Places
from lta_flight.ingredients import Ingredients
from lta_flight.loop import Loop
from lta_flight.policy import Policy
from lta_model.scenario import Scenario
from lta_model.vehicle import Vehicle
from lta_sim.readings import Outcome
from lta_sim.world import World
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Sensors = Literal['all', 'imu', 'pose', 'wrench']

POSE: Final = 1e-3  # m; of a tracker of passive markers
TURN: Final = 2.5e-3  # rad
CLEAR: Final = 0.05  # m above where it stands; below it the floor may be touched
STANDARD: Final = 101325.0  # Pa
KEPT: Final[dict[str, tuple[str, ...]]] = {
    'all': ('rates', 'force', 'range', 'pressure', 'voltage'),
    'imu': ('rates', 'force'),
    'pose': (),
    'wrench': (),
}


def along(made: Ingredients, course: Mapping[str, Any], length: float) -> Ingredients:
    """Return a flight along a course, as a scenario file has it, for so long. [s]"""
    scene = made.contents['scenario']
    goal = {**scene['goal'], 'time_limit': {'value': length, 'unit': 's'}}
    scene = {**scene, 'goal': goal, 'course': course}
    return replace(made, contents={**made.contents, 'scenario': scene})


@final
@dataclass(frozen=True, slots=True)
class Rehearsed:
    """
    What came of it.

    Attributes
    ----------
    streams : Streams
        As a recording would have them.
    outcome : Outcome
        How it ended.
    path : ndarray, shape (n, 3)
        Of the hull centre, the truth. [m, map]
    duties : ndarray, shape (n, rotors)
        Commanded.
    tilt : float
        The greatest. [rad]
    standing : float
        Height of the hull centre of the vehicle when it stands. [m]

    """

    streams: Streams
    outcome: Outcome
    path: Array
    duties: Array
    tilt: float
    standing: float


def rehearse(
    vehicle: Vehicle, scenario: Scenario, policy: Policy, seed: int, known: Vehicle | None = None
) -> Rehearsed:
    """
    Fly a scenario in this process.

    Parameters
    ----------
    vehicle : Vehicle
        As it is taken to be.
    scenario : Scenario
        The scene, with a course.
    policy : Policy
        What the drone decides by.
    seed : int
        Of all chance.
    known : Vehicle, optional
        As the drone knows it; by default as it is.

    """
    table = topic_table()
    world = World(vehicle, scenario, table, seed)
    loop = Loop(world, table, policy, known or Vehicle(vehicle.file))
    rows: dict[str, list[tuple[float, ...]]] = {
        name: [] for name in ('pose', 'commands', *KEPT['all'])
    }
    for outcome in loop.flight():
        if outcome is not Outcome.FLYING:
            break
        _take(loop, rows)
    streams = {name: _stream(found) for name, found in rows.items() if found}
    pose, commands = streams.pop('pose'), streams.pop('commands')
    path, upright = pose.values[:, :3].copy(), _upright(pose.values[:, 3:])
    seen = _tracked(pose, np.random.default_rng([seed, 9]))
    standing = vehicle.standing_height
    return Rehearsed(
        Streams(seen, commands, streams, standing + CLEAR),
        world.outcome,
        path,
        commands.values,
        float(np.arccos(np.clip(upright.min(), -1.0, 1.0))),
        standing,
    )


def _take(loop: Loop, rows: dict[str, list[tuple[float, ...]]]) -> None:
    """Write one step down."""
    told, now = loop.readings, loop.world.elapsed
    if told.truth is not None:
        rows['pose'].append((now, *told.truth[:7]))
    rows['rates'].append((now, *told.rates))
    rows['force'].append((now, *told.force))
    for stamp, distance in told.ranges:
        rows['range'].append((now + (stamp - told.stamp_ns) * 1e-9, distance))
    if told.pressure is not None:
        rows['pressure'].append((now, told.pressure))
    if told.battery is not None:
        rows['voltage'].append((now, told.battery[0]))
    rows['commands'].append((now, *loop.duties))


def _stream(rows: list[tuple[float, ...]]) -> Stream:
    table = np.array(rows)
    return Stream(table[:, 0], table[:, 1:])


def _upright(quaternion: Array) -> Array:
    """Return the cosine of the tilt."""
    x, y, _, _ = quaternion.T
    cosine: Array = 1.0 - 2.0 * (x**2 + y**2)
    return cosine


def _tracked(pose: Stream, rng: np.random.Generator) -> Stream:
    """Return a pose with the noise of a tracker."""
    values = pose.values.copy()
    values[:, :3] += POSE * rng.standard_normal((len(values), 3))
    wobble = exponential(TURN * rng.standard_normal((len(values), 3)))
    values[:, 3:] = product(values[:, 3:], wobble)
    return Stream(pose.time, values)


def seen_by(streams: Streams, sensors: Sensors) -> Streams:
    """Return a recording with the readings of some sensors only; the pose is always there."""
    others = {name: streams.others[name] for name in KEPT[sensors] if name in streams.others}
    return replace(streams, others=others)


def prepared(
    streams: Streams, vehicle: Vehicle, knobs: list[Knob], sensors: Sensors = 'all'
) -> Linearised:
    """
    Return a flight ready to be linearised.

    Of `wrench`, what the rotors gave counts as commanded as such, and nobody knows their duties.
    """
    streams = seen_by(streams, sensors)
    still = vehicle.command(())
    flight = measured(streams)
    if sensors == 'wrench':
        wrench = _wrench(Replay(flight, windows(flight), still), Nominal.of(vehicle))
        silent = Stream(streams.commands.time[:1], 0.0 * streams.commands.values[:1])
        flight = replace(flight, commands=silent, wrench=wrench)
    places = Places.of(vehicle, STANDARD)
    places = Places.of(vehicle, floor_pressure(flight, places))
    ready = Linearised(Replay(flight, windows(flight), still), knobs, places)
    return ready.with_knots(knots_for([ready], Nominal.of(vehicle)))


def _wrench(replay: Replay, nominal: Nominal) -> Stream:
    """Return the force and moment of the rotors about the hull centre, body frame."""
    thrusts = replay.thrusts(nominal.rows())
    each = [np.concatenate([axis, np.cross(place, axis)]) for place, axis in nominal.rotors]
    time = replay.flight.time[0] + replay.dt * np.arange(len(thrusts))
    return Stream(time, thrusts[:, : len(each)] @ np.array(each))
