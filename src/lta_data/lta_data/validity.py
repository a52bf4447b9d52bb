"""
Compare a flight with the region of validity of a vehicle file.

Numbers that were fitted to forecasts are valid in the speeds, rates, attitudes and commands of
their flights. Elsewhere they extrapolate, and can be worse than the file before the fit.
"""

from collections.abc import Mapping
from typing import Final

from lta_config.schema.vehicle_file import MOTION, VehicleFile
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.scene import read_scene
from lta_model.attitude import to_euler_angles
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHARE: Final = 0.05  # of a flight; a shorter time outside is not reported
TRUTH: Final = 'ground_truth/odom'
COMMANDS: Final = 'motors'


def list_motion(quaternion: Array, velocity: Array, rates: Array) -> dict[str, Array]:
    """
    Return the quantities of a motion that a region of validity limits.

    `quaternion`, shape (n, 4): body to map, as x, y, z, w. `velocity`, `rates`, shape (n, 3): in
    the body frame [m/s, rad/s].
    """
    _, pitch, roll = to_euler_angles(quaternion)
    values = (np.linalg.norm(velocity, axis=1), roll, pitch, *rates.T)
    return dict(zip(MOTION, values, strict=True))


def describe_exceeded_region(vehicle: VehicleFile, motion: Mapping[str, Array]) -> str:
    """
    Return a warning if a flight leaves the region of validity of its vehicle file, else ''.

    `motion`, shape (n,): quantities of `list_motion`, and the duty of each rotor by its name; NaN
    where unknown.
    """
    if vehicle.validity is None:
        return ''
    out = []
    for name, limits in vehicle.validity.limits.items():
        values = motion.get(name, np.zeros(0))
        values = values[np.isfinite(values)]
        low, high = limits.vector
        if np.sum((values < low) | (values > high)) <= SHARE * len(values):
            continue
        unit = '' if limits.unit == '1' else f' {limits.unit}'
        out.append(
            f'{name.replace("_", " ")} {values.min():.2g} to {values.max():.2g} '
            f'(fitted: {low:.2g} to {high:.2g}){unit}'
        )
    if not out:
        return ''
    return (
        f'The numbers of vehicle {vehicle.name} were fitted to other flights and extrapolate '
        f'here: {", ".join(out)}.'
    )


def describe_exceeded_region_of_bag(flight: RecordedFlight) -> str:
    """Return the same for a recorded flight; '' without its vehicle file or motion."""
    vehicle = read_scene(flight.provenance).vehicle
    if vehicle is None or vehicle.validity is None or TRUTH not in flight.topics:
        return ''
    table = flight.read_topics([one for one in (TRUTH, COMMANDS) if one in flight.topics])

    def columns(path: str, axes: str) -> Array:
        return np.column_stack([table[TRUTH][f'{path}.{axis}'] for axis in axes])

    motion = list_motion(
        columns('pose.pose.orientation', 'xyzw'),
        columns('twist.twist.linear', 'xyz'),
        columns('twist.twist.angular', 'xyz'),
    )
    if COMMANDS in table:
        numbers = table[COMMANDS].numbers
        motion |= {
            rotor: numbers[f'effort.{rotor}']
            for rotor in vehicle.rotors
            if f'effort.{rotor}' in numbers
        }
    return describe_exceeded_region(vehicle, motion)
