"""Where a vehicle was in a flight and what its rotors were told, out of a bag."""

from typing import Final, final, NamedTuple

from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import RecordedFlight
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
POSES: Final = ('ground_truth/odom', 'odom')  # the truth or a tracker first


@final
class VehiclePath(NamedTuple):
    """
    Where the vehicle was: time [s], hull centre in map [m] and attitude (x y z w).

    Velocities are fitted to it, so that a tracker which knows poses only will do.
    """

    time: Array
    place: Array
    attitude: Array


@final
class RotorCommands(NamedTuple):
    """Duties of the rotors over time, shape (n, rotors), in the order of the vehicle. [s, 1]"""

    time: Array
    duties: Array


def read_flight_record(
    flight: RecordedFlight, vehicle: Vehicle
) -> tuple[VehiclePath, RotorCommands, str]:
    """
    Return path and commands of a recorded flight, and the topic of its poses.

    Raises
    ------
    BadInput
        If the bag has no duties or poses, or duties of other rotors.

    """
    topic = next((name for name in POSES if name in flight.topics), None)
    if topic is None or 'motors' not in flight.topics:
        raise BadInput(
            f"'{flight.bag.path}' has no {'motors' if topic else 'odom'} to weigh by; record it."
        )
    poses, motors = flight.read_series(topic), flight.read_series('motors')
    if not len(poses) or not len(motors):
        raise BadInput(f"'{flight.bag.path}' has no message on motors or {topic}; record both.")
    names = [
        str(motors.texts[f'name[{i}]'][-1])
        for i in range(len(vehicle.rotors))
        if f'name[{i}]' in motors.texts
    ]
    if missing := [name for name in vehicle.rotor_names if name not in names]:
        raise BadInput(
            f"'{flight.bag.path}' has no duty of {', '.join(missing)} of {vehicle.file.name}; "
            'name the vehicle that flew with --vehicle.'
        )
    order = [names.index(name) for name in vehicle.rotor_names]
    duties = np.stack([motors[f'effort[{i}]'] for i in order], axis=1).astype(np.float64)
    path = VehiclePath(
        poses.time, poses.vector('pose.pose.position'), poses.vector('pose.pose.orientation')
    )
    return path, RotorCommands(motors.time, np.nan_to_num(duties)), topic
