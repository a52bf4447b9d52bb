# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the messages of a simulated drone from the readings of its sensors."""

from collections.abc import Iterator
from typing import Any

from lta_graph.ros import vehicle_messages as messages
from lta_graph.ros.stamps import to_stamp
from lta_sim.drone import SimulatedDrone
from lta_sim.readings import SensorReadings
from lta_sim.world import World

TopicMessage = tuple[str, Any]  # the name in the topic table, and the message


def iterate_motion(world: World, readings: SensorReadings) -> Iterator[TopicMessage]:
    """Yield range, pressure and IMU, the last of which the estimator answers."""
    stamp = to_stamp(readings.stamp_ns)
    for taken_ns, distance in readings.ranges:
        taken, sensor = to_stamp(taken_ns), world.range_settings
        limits = sensor.minimum, sensor.maximum
        yield (
            'range',
            messages.build_range_message(taken, distance, limits, sensor.field_of_view),
        )
    if readings.pressure is not None:
        noise = world.pressure_settings.noise
        yield 'pressure', messages.build_pressure_message(stamp, readings.pressure, noise)
    noises = world.imu_errors.noise
    yield 'imu', messages.build_imu_message(stamp, readings.force, readings.rates, noises)


def iterate_rest(world: World, readings: SensorReadings) -> Iterator[TopicMessage]:
    """Yield truth, light and energy, as far as they are due."""
    stamp = to_stamp(readings.stamp_ns)
    if readings.truth is not None:
        yield 'ground_truth/odom', messages.build_odometry(stamp, readings.truth)
    if readings.block is not None:
        begun_ns, block = readings.block
        yield 'photodiodes', messages.build_light_block_message(to_stamp(begun_ns), block)
    # The meters are read less often than the IMU
    if readings.illuminance is None or readings.battery is None or readings.panel is None:
        return
    yield 'wind', messages.build_wind_message(stamp, world.wind)
    yield 'illuminance', messages.build_illuminance_message(stamp, readings.illuminance)
    yield 'panel', messages.build_battery_state(stamp, *readings.panel, 'panel')
    yield 'battery', messages.build_battery_state(stamp, *readings.battery, 'battery')


def sense_motion(drone: SimulatedDrone) -> Iterator[TopicMessage]:
    """Read the sensors of the estimator at the present step, and yield their messages."""
    drone.readings = drone.world.sense_motion()
    return iterate_motion(drone.world, drone.readings)


def sense_rest(drone: SimulatedDrone) -> Iterator[TopicMessage]:
    """Read the other sensors at the present step, and yield their messages."""
    drone.world.sense_rest(drone.readings)
    return iterate_rest(drone.world, drone.readings)
