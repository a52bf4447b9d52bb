# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Clean flights for the trust checks: simulated ones of many kinds, and real ones where they are.

Simulated flights come out of the loop in one process as channels, without a bag. Some say that
they are simulated; the others pose as measured, so their ground truth has a tracker's noise.
Real ones are read from their published columns (`../shared/data` beside the project).
"""

from collections.abc import Iterator, Mapping
import math
import os
from pathlib import Path
from typing import Any, Final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.files import find_file
from lta_data.bag.channels import BLOCK_STATISTICS
from lta_data.flight import Channel, Flight
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_spec import build_loop, load_spec
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from campaigns import ROOT

Array = NDArray[np.float64]
DATA: Final = Path(os.environ.get('LTA_DATA', ROOT.parent / 'shared' / 'data'))
VEHICLES: Final = ('gtmab', 'gtmab', 'blimp2b', 'sblimp', 'multirotor', 'beavis', 'skye')
SCENARIOS: Final = ('lamp_room', 'breeze', 'gusty_hall', 'hall', 'windy_field')
MEASURED: Final = {'data': 'measured'}
SIMULATED: Final = {'seed': '', 'scenario': ''}
XYZ: Final = ('x', 'y', 'z')
ODOMETRY: Final = ('pose.pose.position', 'pose.pose.orientation', 'twist.twist.linear')
TURN: Final = 'twist.twist.angular'


def vector(topic: str, path: str, unit: str, time: Array, table: Array) -> Iterator[Channel]:
    parts = ('x', 'y', 'z', 'w')[: table.shape[1]]
    for part, column in zip(parts, table.T, strict=True):
        yield Channel(f'{topic}/{path}.{part}', unit, time, np.ascontiguousarray(column))


def odometry(
    topic: str, time: Array, place: Array, turn: Array, speed: Array, rates: Array
) -> Iterator[Channel]:
    """Yield the channels of an odometry topic; `turn` are quaternions x y z w."""
    position, orientation, linear = ODOMETRY
    yield from vector(topic, position, 'm', time, place)
    yield from vector(topic, orientation, '1', time, turn)
    for part, values in zip(('yaw', 'pitch', 'roll'), to_euler_angles(turn), strict=True):
        yield Channel(f'{topic}/{orientation}.{part}', 'rad', time, values, angular=True)
    yield from vector(topic, linear, 'm/s', time, speed)
    yield from vector(topic, TURN, 'rad/s', time, rates)


def recording(channels: Iterator[Channel], provenance: Mapping[str, str]) -> Flight:
    return Flight({channel.name: channel for channel in channels}, provenance)


# Simulated


def flown(vehicle: str, scenario: str, strategy: str, seed: int, length: float) -> dict[str, Any]:
    """Fly one flight of at most so many seconds; return what was sensed, as lists by topic."""
    loop = build_loop(load_spec(vehicle, scenario, strategy, ''), seed)
    kept: dict[str, Any] = {name: [] for name in KEPT}
    kept['rotors'] = loop.world.vehicle.rotor_names
    begun = loop.world.stamp_ns
    for _ in loop.iterate_steps():
        take(loop, kept, begun)
        if loop.world.elapsed >= length:
            break
    return kept


KEPT: Final = (
    'imu', 'range', 'pressure', 'truth', 'odom', 'motors', 'battery', 'illuminance', 'block',
)  # fmt: skip


def take(loop: ClosedLoop, kept: dict[str, Any], begun: int) -> None:
    """Keep the newest step."""
    readings = loop.readings
    now = (readings.stamp_ns - begun) * 1e-9
    kept['imu'].append((now, *readings.rates, *readings.force))
    kept['range'] += [((stamp - begun) * 1e-9, value) for stamp, value in readings.ranges]
    kept['motors'].append((now, *loop.duties))
    if readings.pressure is not None:
        kept['pressure'].append((now, readings.pressure))
    if readings.truth is not None:
        kept['truth'].append((now, *readings.truth))
    if readings.battery is not None:
        kept['battery'].append((now, *readings.battery))
        kept['illuminance'].append((now, readings.illuminance or 0.0))
    if readings.block is not None:
        stamp, block = readings.block
        columns = [reduced(block, axis=0) for reduced in BLOCK_STATISTICS.values()]
        kept['block'].append(((stamp - begun) * 1e-9, *np.concatenate(columns)))


def simulated(seed: int, vehicle: str | None = None) -> Flight:
    """Return the clean flight of a seed: vehicle, scene, length and topics are drawn by it."""
    rng = np.random.default_rng([seed, 4])
    kept = None
    while kept is None or not flew(kept):
        craft = vehicle or VEHICLES[int(rng.integers(len(VEHICLES)))]
        scenario = SCENARIOS[int(rng.integers(len(SCENARIOS)))]
        kept = flown(craft, scenario, 'bag', seed, float(rng.uniform(15.0, 25.0)))
    declared = bool(rng.random() < 0.4)
    topics = subset(rng)
    channels = dict(of_flown(kept, rng, declared))
    chosen = (channel for topic in topics for channel in channels.get(topic, ()))
    file = {'vehicle_file': find_file('vehicle', craft).read_text(encoding='utf-8')}
    return recording(chosen, (SIMULATED if declared else MEASURED) | file)


def flew(kept: dict[str, Any]) -> bool:
    """Whether the craft left its place and never toppled: else it is no clean flight."""
    truth = np.array(kept['truth'])
    up = 1.0 - 2.0 * (truth[:, 4] ** 2 + truth[:, 5] ** 2)
    return bool(up.min() > 0.7 and np.ptp(truth[:, 1:4], axis=0).max() > 0.3)


def subset(rng: Generator) -> list[str]:
    """Draw the topics of a flight: all, pose alone, pose and IMU, IMU and more without a pose."""
    sets = (
        [*KEPT], [*KEPT], ['truth'], ['truth', 'imu'], ['truth', 'imu', 'motors'],
        ['imu', 'range', 'pressure', 'motors', 'battery'],
        ['truth', 'range', 'pressure', 'motors'],
    )  # fmt: skip
    return sets[int(rng.integers(len(sets)))]


def of_flown(
    kept: dict[str, Any], rng: Generator, declared: bool
) -> Iterator[tuple[str, list[Channel]]]:
    """Yield the channels of each topic of a flight."""
    tables = {name: np.array(kept[name], dtype=np.float64) for name in KEPT if len(kept[name])}
    imu = tables['imu']
    yield (
        'imu',
        [
            *vector('imu', 'angular_velocity', 'rad/s', imu[:, 0], imu[:, 1:4]),
            *vector('imu', 'linear_acceleration', 'm/s2', imu[:, 0], imu[:, 4:7]),
        ],
    )
    singles = {
        'range': ('range/range', 'm', 1),
        'pressure': ('pressure/fluid_pressure', 'Pa', 1),
        'illuminance': ('illuminance/illuminance', 'lx', 1),
    }
    for name, (channel, unit, column) in singles.items():
        yield name, [Channel(channel, unit, tables[name][:, 0], tables[name][:, column])]
    battery = tables['battery']
    yield (
        'battery',
        [
            Channel('battery/voltage', 'V', battery[:, 0], battery[:, 1]),
            Channel('battery/current', 'A', battery[:, 0], battery[:, 2]),
        ],
    )
    motors = tables['motors']
    yield (
        'motors',
        [
            Channel(f'motors/effort.{name}', '1', motors[:, 0], motors[:, 1 + index])
            for index, name in enumerate(kept['rotors'])
        ],
    )
    yield 'truth', list(of_truth(tables['truth'], rng, declared))
    if 'block' in tables:
        yield 'block', list(of_blocks(tables['block']))


def of_blocks(table: Array) -> Iterator[Channel]:
    """Yield what ADC blocks come to."""
    diodes = (table.shape[1] - 1) // len(BLOCK_STATISTICS)
    for index, what in enumerate(BLOCK_STATISTICS):
        for diode in range(diodes):
            column = table[:, 1 + index * diodes + diode]
            yield Channel(f'photodiodes/{what}[{diode}]', 'ADC counts', table[:, 0], column)


def of_truth(table: Array, rng: Generator, declared: bool) -> Iterator[Channel]:
    """Yield ground truth, with a tracker's noise where it poses as measured."""
    every = 1 if declared else int(rng.choice([1, 1, 2, 4]))
    table = table[::every]
    time, place, turn = table[:, 0], table[:, 1:4], table[:, 4:8]
    speed, rates = table[:, 8:11], table[:, 11:14]
    if not declared:
        size = float(rng.uniform(0.5, 3.0))

        def noise(rms: float) -> Array:
            return rng.normal(0.0, size * rms, place.shape)

        place, speed = place + noise(5e-5), speed + noise(1e-3)
        rates = rates + noise(5e-3)
        turn = (Rotation.from_quat(turn) * Rotation.from_rotvec(noise(3e-4))).as_quat()
    yield from odometry('ground_truth/odom', time, place, turn, speed, rates)


# Real


def columns(path: Path) -> Any:
    """Return a table with named columns."""
    return np.genfromtxt(path, delimiter=',', names=True)


def rgblimp_files() -> list[Path]:
    """Return the flights of RGBlimp; none where the data are absent."""
    return sorted((DATA / 'rgblimp').glob('*.csv.gz'))


def crazyflie_files() -> list[Path]:
    """Return the Crazyflie flights; none where the data are absent."""
    return sorted((DATA / 'crazyflie_flights').glob('*.csv.gz'))


def rgblimp(path: Path) -> Flight:
    """Return a flight of RGBlimp: z down becomes z up, body FRD becomes FLU; 60 Hz."""
    table = columns(path)
    time = np.arange(len(table)) / 60.0

    def three(name: str) -> Array:
        return np.stack([table[f'{name}_{axis}'] for axis in (1, 2, 3)], axis=1)

    flip = np.array([1.0, -1.0, -1.0])
    turn = Rotation.from_euler('ZYX', three('e')[:, ::-1]).as_quat()
    turn *= np.array([1.0, -1.0, -1.0, 1.0])
    pose = odometry(
        'ground_truth/odom', time, three('p') * flip, turn, three('vb') * flip, three('wb') * flip
    )
    force = [
        Channel(
            'wrench_command/wrench.force.x', 'N', time, table['Fl_series'] + table['Fr_series']
        )
    ]
    return recording(iter([*pose, *force]), MEASURED)


def crazyflie(path: Path) -> Flight:
    """Return a Crazyflie flight: Vicon, IMU, commands and battery at 100 Hz."""
    table = columns(path)
    time = table['t'] - table['t'][0]

    def named(*names: str) -> Array:
        return np.stack([table[name] for name in names], axis=1)

    turn = named('qx', 'qy', 'qz', 'qw')
    speed = Rotation.from_quat(turn).inv().apply(named('vx', 'vy', 'vz'))
    rates = named('wx_vicon', 'wy_vicon', 'wz_vicon')
    pose = odometry('ground_truth/odom', time, named('px', 'py', 'pz'), turn, speed, rates)
    gyro = named('imu_gyro_x', 'imu_gyro_y', 'imu_gyro_z')
    force = named('imu_acc_x', 'imu_acc_y', 'imu_acc_z') * STANDARD_GRAVITY
    rest = [
        *vector('imu', 'angular_velocity', 'rad/s', time, gyro),
        *vector('imu', 'linear_acceleration', 'm/s2', time, force),
        Channel('battery/voltage', 'V', time, table['pwr_pm_vbat']),
    ]
    duties = [
        Channel(f'motors/effort.m{n}', '1', time, table[f'motor_motor_m{n}'] / 65535.0)
        for n in (1, 2, 3, 4)
    ]
    return recording(iter([*pose, *rest, *duties]), MEASURED)


def piece(whole: Flight, begin: float, end: float) -> Flight:
    """Return a part of a recording, with its time starting at zero [s]."""
    cut = {}
    for name, channel in whole.channels.items():
        inside = (channel.time >= begin) & (channel.time < end)
        cut[name] = Channel(
            name, channel.unit, channel.time[inside] - begin, channel.values[inside],
            channel.angular,
        )  # fmt: skip
    return Flight(cut, whole.provenance)


def length(flight: Flight) -> float:
    """Return the time to the last sample [s]."""
    return max(
        (float(c.time[-1]) for c in flight.channels.values() if len(c.time)), default=math.nan
    )
