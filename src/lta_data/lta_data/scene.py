# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read scenario and vehicle from the provenance of a bag.

Numbers that were fitted to forecasts are valid in the speeds, rates, attitudes and commands of
their flights. Elsewhere they extrapolate, and can be worse than the file before the fit.

A recording may come from anybody. Its numbers and the names of what LTA ships may act; whatever
names a file never does, as a stranger would choose what is opened.
"""

from collections.abc import Collection, Mapping
from functools import lru_cache
import re
from typing import Any, Final, final, NamedTuple, TypeVar

from lta_config.errors import BadInput
from lta_config.files import (
    format_error,
    parse_yaml,
)
from lta_config.schema.vehicle_file import REGION_QUANTITIES, VehicleFile
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.bag.table import stack_components
from lta_model.attitude import to_euler_angles
from lta_model.scenario import Scenario
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

Model = TypeVar('Model', bound=BaseModel)


@final
class RecordedScene(NamedTuple):
    """Scenario and vehicle stored in a bag; None if missing."""

    scenario: Scenario | None
    vehicle: VehicleFile | None


def read_scene(provenance: Mapping[str, str]) -> RecordedScene:
    """
    Read scenario and vehicle from a bag's provenance.

    Raise `BadInput` if the bag contains a file that cannot be read.
    """
    return RecordedScene(
        parse_provenance_file(Scenario, provenance, 'scenario_file'),
        parse_provenance_file(VehicleFile, provenance, 'vehicle_file'),
    )


def parse_provenance_file(
    model: type[Model], provenance: Mapping[str, str], key: str
) -> Model | None:
    """Parse one file of the provenance, which names no other; None if it is missing."""
    return _parse_model(model, provenance[key], key) if key in provenance else None


@lru_cache(maxsize=32)  # a study reads the same few files often; the models are frozen
def _parse_model(model: type[Model], text: str, key: str) -> Model:
    content = read_recorded_file({key: text}, key)
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise BadInput(
            f"The bag's {key} cannot be read by this version of LTA: {format_error(error)}"
        ) from error


TRACKERS: Final = ('ground_truth/odom', 'ground_truth/pose', 'pose', 'mocap/pose', 'vrpn/pose')
NO_TRACKER: Final = ('odom', 'setpoint', 'light', 'estimate')  # poses that are not measurements
POSITION_CHANNEL: Final = 'position.x'
COMMAND_CHANNEL: Final = 'motors/effort.'
MASS_CHANNELS: Final = tuple(f'motors/position.moving_mass_{axis}' for axis in 'xyz')
NEWTONS: Final = frozenset({'N', 'mN'})  # units of imported thrust commands


def find_tracker_prefix(channels: Collection[str]) -> str:
    """
    Return the prefix of the tracked pose's channels: 'ground_truth/odom/pose.pose.'.

    Raise `BadInput` if no measured pose was recorded.
    """
    prefixes = [
        name.removesuffix(POSITION_CHANNEL)
        for name in channels
        if name.endswith(POSITION_CHANNEL)
        and f'{name.removesuffix(POSITION_CHANNEL)}orientation.yaw' in channels
    ]
    # Estimates and setpoints also have poses, but are not measurements
    free = [name for name in prefixes if not name.startswith(NO_TRACKER)]
    for topic in TRACKERS:
        for name in free:
            if name.startswith(f'{topic}/'):
                return name
    if free:
        return free[0]
    raise BadInput(
        'The recording has no measured pose, so no model can be compared with it; record one of '
        f'the topics {", ".join(TRACKERS)}.'
    )


def has_newton_commands(provenance: Mapping[str, str]) -> bool | None:
    """Return whether the commands of an import are in newtons; None if it does not state that."""
    text = provenance.get('mapping_file')
    if not text:
        return None
    # Not validated against the current schema: a recording may be of an older version.
    try:
        mapping = parse_yaml(text, 'The mapping')
    except BadInput:
        return None
    for topic in _list_dicts(mapping, 'topics'):
        if topic.get('topic') == 'motors':
            efforts = [actuator.get('effort') for actuator in _list_dicts(topic, 'actuators')]
            return any(isinstance(each, dict) and each.get('unit') in NEWTONS for each in efforts)
    return None


def _list_dicts(holder: object, name: str) -> list[dict[str, Any]]:
    """Return the entries of a list, or the values of a dictionary, that are dictionaries."""
    content = holder.get(name) if isinstance(holder, dict) else None
    # A mapping by name, or a list
    each = [*content.values()] if isinstance(content, dict) else content
    return [entry for entry in each if isinstance(entry, dict)] if isinstance(each, list) else []


Array = NDArray[np.float64]

SHARE: Final = 0.05  # of a flight; a shorter time outside is not reported
TRUTH_TOPIC: Final = 'ground_truth/odom'
COMMANDS: Final = 'motors'


def list_motion(quaternion: Array, velocity: Array, rates: Array) -> dict[str, Array]:
    """
    Return the quantities of a motion that a region of validity limits.

    `quaternion`, shape (n, 4): body to map, as x, y, z, w. `velocity`, `rates`, shape (n, 3): in
    the body frame [m/s, rad/s].
    """
    _, pitch, roll = to_euler_angles(quaternion)
    values = (np.linalg.norm(velocity, axis=1), roll, pitch, *rates.T)
    return dict(zip(REGION_QUANTITIES, values, strict=True))


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
    if vehicle is None or vehicle.validity is None or TRUTH_TOPIC not in flight.topics:
        return ''
    truth = flight[TRUTH_TOPIC]
    motion = list_motion(
        stack_components(truth, 'pose.pose.orientation'),
        stack_components(truth, 'twist.twist.linear'),
        stack_components(truth, 'twist.twist.angular'),
    )
    if COMMANDS in flight.topics:
        duties = flight[COMMANDS]
        motion |= {
            rotor: duties[f'effort.{rotor}'].to_numpy()
            for rotor in vehicle.rotors
            if f'effort.{rotor}' in duties
        }
    return describe_exceeded_region(vehicle, motion)


# Where a recorded file may name another one. The recording has its own copy of the gains, and what
# the recorded wind did is in its data; without the others the file has no meaning
OMITTED: Final = {'vehicle_file': ('control.gains',), 'scenario_file': ('air.recorded',)}
REFUSED: Final = {'vehicle_file': ('aero', 'energy.array.cell')}
GAINS: Final = (
    '/**/controller',
    'ros__parameters',
    'gains',
)  # the only parameters of a gains file
SHIPPED: Final = re.compile('[A-Za-z0-9_-]*')  # a name of a file of LTA, which is no path
NUMBERS: Final = (bool, int, float)


def read_recorded_file(provenance: Mapping[str, str], key: str) -> Any:
    """
    Return the content of a vehicle, scenario or gains file in a recording; it names no file.

    `key`: 'vehicle_file', 'scenario_file' or 'gains_file'; None if it is missing. Raise `BadInput`
    if it is no YAML, or cannot do without a file that it names.
    """
    if key not in provenance:
        return None
    content = parse_yaml(provenance[key], f"The bag's {key}")
    if key == 'gains_file':
        return _keep_gains(content)
    for path in (*OMITTED.get(key, ()), *REFUSED.get(key, ())):
        *above, last = path.split('.')
        holder = content
        for name in above:
            holder = holder.get(name) if isinstance(holder, dict) else None
        value = holder.get(last) if isinstance(holder, dict) else None
        if not isinstance(value, str) or SHIPPED.fullmatch(value):
            continue
        if path in REFUSED.get(key, ()):
            raise BadInput(
                f"The bag's {key} names the file '{value}' in {path}, and no file is opened "
                'because a recording names it; use your own copy of the vehicle file, with '
                '--vehicle where a command has it.'
            )
        del holder[last]
    return content


def _keep_gains(content: Any) -> Any:
    """Return a parameter file with nothing but the gains of the controller."""
    gains = content
    for name in GAINS:
        gains = gains.get(name) if isinstance(gains, dict) else None
    if not _holds_numbers(gains):
        raise BadInput(
            f"The bag's gains_file has no gains under {', '.join(GAINS)} that are numbers; give "
            'others with --gains.'
        )
    for name in reversed(GAINS):
        gains = {name: gains}
    return gains


def _holds_numbers(content: object) -> bool:
    if isinstance(content, dict):
        return all(isinstance(key, str) and _holds_numbers(content[key]) for key in content)
    if isinstance(content, list):
        return all(map(_holds_numbers, content))
    return isinstance(content, NUMBERS)
