# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read poses and commands of a recorded flight from a bag: rotor duties, or a wrench."""

from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import stack_components
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
POSE_TOPICS: Final = (
    'ground_truth/odom',
    'odom',
)  # in order of preference: truth or tracker first
WRENCH_TOPIC: Final = 'wrench_command'  # used where there are no duties


@final
class VehiclePath(NamedTuple):
    """
    Measured path: time [s], hull centre in map [m] and attitude quaternion (x y z w).

    It has no velocities, since a tracker may measure poses only; they are fitted later.
    """

    time: Array
    place: Array
    attitude: Array


@final
class RotorCommands(NamedTuple):
    """Rotor duties over time [s, 1], shape (n, rotors), in the order of the vehicle file."""

    time: Array
    duties: Array


@final
class WrenchCommands(NamedTuple):
    """Commanded force in the body frame over time [s, N], shape (n, 3)."""

    time: Array
    force: Array


def read_flight_record(
    flight: RecordedFlight, vehicle: Vehicle
) -> tuple[VehiclePath, RotorCommands | WrenchCommands, str]:
    """
    Read path and commands of a recorded flight, and return the topic of its poses.

    Raise `BadInput` if the bag lacks commands or poses, or its rotors are not those of the
    vehicle.
    """
    topic = next((name for name in POSE_TOPICS if name in flight.topics), None)
    wrench = 'motors' not in flight.topics and WRENCH_TOPIC in flight.topics
    if topic is None or ('motors' not in flight.topics and not wrench):
        raise BadInput(
            f"The recording '{flight.bag.path}' has no topic "
            f'{"motors" if topic else "odom"}; record that topic too.'
        )
    orders = WRENCH_TOPIC if wrench else 'motors'
    poses, motors = flight[topic], flight[orders]
    if not len(poses) or not len(motors):
        raise BadInput(
            f"The recording '{flight.bag.path}' has no messages on the topics {orders} or "
            f'{topic}; record both topics.'
        )
    path = VehiclePath(
        poses.index.to_numpy(),
        stack_components(poses, 'pose.pose.position'),
        stack_components(poses, 'pose.pose.orientation'),
    )
    time = motors.index.to_numpy()
    if wrench:
        # A missing force is not commanded
        force = np.nan_to_num(stack_components(motors, 'wrench.force'))
        return path, WrenchCommands(time, force), topic
    columns = [f'effort.{name}' for name in vehicle.rotor_names]
    if missing := [name for name in vehicle.rotor_names if f'effort.{name}' not in motors]:
        raise BadInput(
            f"The recording '{flight.bag.path}' has no motor duties for "
            f'{", ".join(missing)}, rotors of {vehicle.file.name}; give the vehicle that '
            'flew with --vehicle.'
        )
    duties = motors[columns].to_numpy(dtype=np.float64)
    # A missing effort is NaN in the bag and means that the rotor stands still
    return path, RotorCommands(time, np.nan_to_num(duties)), topic
