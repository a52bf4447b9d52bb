"""
What a message of each type can be told by an import: its parts, their units, axes and places.

The topics are those of the topic table, and `wrench_command` for vehicles that are driven by body
forces instead of actuators. What nobody tells is NaN, and where the message has a covariance its
first element is -1 (REP-145's habit).
"""

from collections.abc import Mapping
from typing import final, Literal, NamedTuple

from lta_config.errors import unknown
from lta_config.topics import topic_table

Kind = Literal['number', 'vector', 'axial', 'attitude']


@final
class Part(NamedTuple):
    """
    One part of a message.

    Attributes
    ----------
    place : str
        Path of the number, or of what has x, y, z (and w).
    dimension : str
        SI unit of it; '' for an attitude.
    kind : str
        'axial' is a vector that keeps its sense in a mirror.
    frame : str
        'world' or 'body', whose axes a vector is in.
    unknown : str
        Path of what is -1 where this part is not known; '' where the message has none.
    share : float
        Message units to one SI unit.

    """

    place: str
    dimension: str
    kind: Kind = 'number'
    frame: Literal['world', 'body', ''] = ''
    unknown: str = ''
    share: float = 1.0


@final
class Target(NamedTuple):
    """A topic that can be imported: message type and frame of its header."""

    type_name: str
    frame: str


WRENCH = Target('geometry_msgs/msg/WrenchStamped', 'base_link')
EXTRA = {'wrench_command': WRENCH}  # recorded where a vehicle is driven by body forces
JOINTS = 'sensor_msgs/msg/JointState'
JOINT_DIMENSIONS: Mapping[str, tuple[str, ...]] = {
    'effort': ('1', 'N', 'N m'),
    'position': ('m', 'rad'),
    'velocity': ('m/s', 'rad/s'),
}
CHILD = {'nav_msgs/msg/Odometry': {'child_frame_id': 'base_link'}}

_POSE = {
    'position': Part('pose.position', 'm', 'vector', 'world'),
    'orientation': Part('pose.orientation', '', 'attitude'),
}
SHAPES: Mapping[str, Mapping[str, Part]] = {
    'nav_msgs/msg/Odometry': {
        'position': Part('pose.pose.position', 'm', 'vector', 'world', 'pose.covariance[0]'),
        'orientation': Part('pose.pose.orientation', '', 'attitude', '', 'pose.covariance[21]'),
        'velocity': Part('twist.twist.linear', 'm/s', 'vector', 'body', 'twist.covariance[0]'),
        'rates': Part('twist.twist.angular', 'rad/s', 'axial', 'body', 'twist.covariance[21]'),
    },
    'sensor_msgs/msg/Imu': {
        'orientation': Part('orientation', '', 'attitude', '', 'orientation_covariance[0]'),
        'rates': Part(
            'angular_velocity', 'rad/s', 'axial', 'body', 'angular_velocity_covariance[0]'
        ),
        'acceleration': Part(
            'linear_acceleration', 'm/s2', 'vector', 'body', 'linear_acceleration_covariance[0]'
        ),
    },
    'geometry_msgs/msg/PoseStamped': _POSE,
    'geometry_msgs/msg/TwistStamped': {
        'velocity': Part('twist.linear', 'm/s', 'vector', 'body'),
        'rates': Part('twist.angular', 'rad/s', 'axial', 'body'),
    },
    'geometry_msgs/msg/WrenchStamped': {
        'force': Part('wrench.force', 'N', 'vector', 'body'),
        'torque': Part('wrench.torque', 'N m', 'axial', 'body'),
    },
    'geometry_msgs/msg/Vector3Stamped': {
        'vector': Part('vector', 'm/s', 'vector', 'world'),
    },
    'sensor_msgs/msg/BatteryState': {
        'voltage': Part('voltage', 'V'),
        'current': Part('current', 'A'),
        'temperature': Part('temperature', 'degC'),
        'percentage': Part('percentage', '1'),
        'charge': Part('charge', 'C', share=1.0 / 3600.0),
        'capacity': Part('capacity', 'C', share=1.0 / 3600.0),
    },
    'sensor_msgs/msg/Range': {
        'range': Part('range', 'm'),
        'minimum': Part('min_range', 'm'),
        'maximum': Part('max_range', 'm'),
        'field_of_view': Part('field_of_view', 'rad'),
    },
    'sensor_msgs/msg/FluidPressure': {'pressure': Part('fluid_pressure', 'Pa')},
    'sensor_msgs/msg/Illuminance': {'illuminance': Part('illuminance', 'lx')},
    JOINTS: {},
}
ELSEWHERE = ('light/bearing',)  # a vector, but without a unit of its own


def targets() -> dict[str, Target]:
    """Return the topics that an import can write, by relative name."""
    listed = {
        name: Target(topic.type, topic.frame)
        for name, topic in topic_table().topics.items()
        if topic.type in SHAPES and name not in ELSEWHERE
    }
    return listed | EXTRA


def target(name: str) -> Target:
    """Return one of them; an unknown name is a `BadInput` that lists the known ones."""
    found = targets()
    if name not in found:
        raise unknown('topic to import into', name, list(found))
    return found[name]
