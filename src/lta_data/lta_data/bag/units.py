"""
Look up the unit of every number in a message, according to the comments of the definitions.

A rule names a message type and one of its fields. It applies to everything inside the field unless
a deeper rule overrides it. REP-103 defines the units; topics of LTA that use a general type for
another quantity are in `OF_TOPIC`.
"""

from collections.abc import Mapping
from functools import cache
import re
from typing import Final

from lta_bridge.bag.schemas import load_jazzy_types
from lta_config.message_files import read_field_units
from lta_data.bag.columns import name_column
from rosbags.interfaces import Nodetype

ONE: Final = '1'
UNKNOWN: Final = ''
RULES: Final = {
    'builtin_interfaces/msg/Time': {'sec': 's', 'nanosec': 'ns'},
    'builtin_interfaces/msg/Duration': {'sec': 's', 'nanosec': 'ns'},
    'geometry_msgs/msg/Pose': {'position': 'm', 'orientation': ONE},
    'geometry_msgs/msg/PointStamped': {'point': 'm'},
    'geometry_msgs/msg/QuaternionStamped': {'quaternion': ONE},
    'geometry_msgs/msg/Transform': {'translation': 'm', 'rotation': ONE},
    'geometry_msgs/msg/Twist': {'linear': 'm/s', 'angular': 'rad/s'},
    'geometry_msgs/msg/Accel': {'linear': 'm/s2', 'angular': 'rad/s2'},
    'geometry_msgs/msg/Wrench': {'force': 'N', 'torque': 'N m'},
    'sensor_msgs/msg/Imu': {
        'orientation': ONE,
        'orientation_covariance': 'rad2',
        'angular_velocity': 'rad/s',
        'angular_velocity_covariance': 'rad2/s2',
        'linear_acceleration': 'm/s2',
        'linear_acceleration_covariance': 'm2/s4',
    },
    'sensor_msgs/msg/Range': {
        'field_of_view': 'rad',
        'min_range': 'm',
        'max_range': 'm',
        'range': 'm',
        'variance': 'm2',
    },
    'sensor_msgs/msg/FluidPressure': {'fluid_pressure': 'Pa', 'variance': 'Pa2'},
    'sensor_msgs/msg/Illuminance': {'illuminance': 'lx', 'variance': 'lx2'},
    'sensor_msgs/msg/Temperature': {'temperature': 'degC', 'variance': 'degC2'},
    'sensor_msgs/msg/RelativeHumidity': {'relative_humidity': ONE, 'variance': ONE},
    'sensor_msgs/msg/MagneticField': {'magnetic_field': 'T', 'magnetic_field_covariance': 'T2'},
    'sensor_msgs/msg/NavSatFix': {
        'latitude': 'deg',
        'longitude': 'deg',
        'altitude': 'm',
        'position_covariance': 'm2',
    },
    'sensor_msgs/msg/BatteryState': {
        'voltage': 'V',
        'temperature': 'degC',
        'current': 'A',
        'charge': 'A h',
        'capacity': 'A h',
        'design_capacity': 'A h',
        'percentage': ONE,
        'cell_voltage': 'V',
        'cell_temperature': 'degC',
    },
    # For revolute joints; OF_TOPIC overrides it.
    'sensor_msgs/msg/JointState': {'position': 'rad', 'velocity': 'rad/s', 'effort': 'N m'},
    'sensor_msgs/msg/Joy': {'axes': ONE, 'buttons': ONE},
    'std_msgs/msg/ColorRGBA': {'r': ONE, 'g': ONE, 'b': ONE, 'a': ONE},
    'visualization_msgs/msg/Marker': {'scale': 'm', 'points': 'm'},
    'visualization_msgs/msg/UVCoordinate': {'u': ONE, 'v': ONE},
}
MATRICES: Final = {  # 6 x 6 covariances of three linear, then three angular components
    'geometry_msgs/msg/PoseWithCovariance': ('m2', 'm rad', 'rad2'),
    'geometry_msgs/msg/TwistWithCovariance': ('m2/s2', 'm rad/s2', 'rad2/s2'),
    'geometry_msgs/msg/AccelWithCovariance': ('m2/s4', 'm rad/s4', 'rad2/s4'),
}
OF_TOPIC: Final = {  # by relative name; overrides the message type
    'motors': {'effort': ONE, 'position': 'm', 'velocity': 'm/s'},
    'wind': {'vector': 'm/s'},
    'light/bearing': {'vector': ONE},
    'light/peaks': {'amplitude': 'ADC counts', 'snr': ONE, 'frequency': 'Hz', 'x': ONE, 'y': ONE}
    | {'z': ONE},
}
_INDEX: Final = re.compile(r'\[(\d+)\]$')


def find_unit(type_name: str, path: str, topic: str = '') -> str:
    """
    Return the unit of a field in REP-103 notation ('m/s2').

    '1' for a dimensionless number, '' if unknown. `path` is as in a `TopicSeries`:
    'pose.pose.position.x', 'effort[0]'; `topic` is the relative name, if known.
    """
    own = OF_TOPIC.get(topic, {}).get(_INDEX.sub('', path.split('.')[0]))
    return _find_type_unit(type_name, path) if own is None else own


@cache
def _collect_rules() -> dict[str, Mapping[str, str]]:
    """Return the rules by type, with those of lta_msgs from the comments of its definitions."""
    own = {
        # By the names of the columns as well
        kind: {**units, **{name_column(kind, field): unit for field, unit in units.items()}}
        for kind, units in read_field_units().items()
    }
    return {**RULES, **own}


@cache
def _find_type_unit(type_name: str, path: str) -> str:
    """Return the unit of a field by its message type."""
    unit, kind = UNKNOWN, type_name
    for part in path.split('.'):
        index = _INDEX.search(part)
        field = _INDEX.sub('', part)
        if kind in MATRICES and field == 'covariance' and index is not None:
            return _find_covariance_unit(MATRICES[kind], int(index.group(1)))
        unit = _collect_rules().get(kind, {}).get(field, unit)
        kind = _find_field_type(kind, field)
    return unit


def _find_covariance_unit(units: tuple[str, str, str], index: int) -> str:
    """Return the unit of an element of a row-major 6 x 6 covariance."""
    row, column = divmod(index, 6)
    return units[(row > 2) + (column > 2)]


@cache
def _find_field_type(kind: str, field: str) -> str:
    """Return the message type of a field; '' if it is not a message."""
    _, fields = load_jazzy_types().fielddefs.get(kind, ([], []))
    for name, field_type in fields:
        if name == field:
            item = (
                field_type[1][0]
                if field_type[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE)
                else field_type
            )
            return str(item[1]) if item[0] is Nodetype.NAME else ''
    return ''
