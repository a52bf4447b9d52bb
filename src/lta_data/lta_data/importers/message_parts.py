"""
Define which parts of each message type an import can fill: units, axes and paths.

The topics are those of the topic table, and `wrench_command` for vehicles driven by body forces
instead of actuators. An unknown part is NaN, and the first element of its covariance is -1, as
sensor_msgs/Imu defines it.
"""

from collections.abc import Mapping
from typing import final, Literal, NamedTuple

from lta_config.errors import unknown_name_error
from lta_config.topics import load_topic_table

Kind = Literal['number', 'vector', 'axial', 'attitude']


@final
class MessagePart(NamedTuple):
    """One part of a message."""

    place: str  # path of the number, or of the parent of x, y, z (and w)
    dimension: str  # its SI unit; '' for an attitude
    # 'axial' for an axial vector, which a reflection leaves unchanged up to sign
    kind: Kind = 'number'
    frame: Literal['world', 'body', ''] = ''  # frame of a vector: 'world' or 'body'
    unknown: str = ''  # path of the element that is -1 if the part is unknown; '' if there is none
    share: float = 1.0  # message units per SI unit


@final
class ImportTarget(NamedTuple):
    """A topic that can be imported: message type and frame_id."""

    type_name: str
    frame: str


WRENCH = ImportTarget('geometry_msgs/msg/WrenchStamped', 'base_link')
JOINTS = 'sensor_msgs/msg/JointState'
JOINT_DIMENSIONS: Mapping[str, tuple[str, ...]] = {
    'effort': ('1', 'N', 'N m'),
    'position': ('m', 'rad'),
    'velocity': ('m/s', 'rad/s'),
}
# A command in a log may be a force or a place, which an ActuatorDuty cannot hold; and vehicles may
# be driven by body forces
EXTRA = {'motors': ImportTarget(JOINTS, 'base_link'), 'wrench_command': WRENCH}
CHILD = {'nav_msgs/msg/Odometry': {'child_frame_id': 'base_link'}}

# No covariance: an unknown quantity can only be NaN
_POSE = {
    'position': MessagePart('pose.position', 'm', 'vector', 'world'),
    'orientation': MessagePart('pose.orientation', '', 'attitude'),
}
SHAPES: Mapping[str, Mapping[str, MessagePart]] = {
    'nav_msgs/msg/Odometry': {
        'position': MessagePart(
            'pose.pose.position', 'm', 'vector', 'world', 'pose.covariance[0]'
        ),
        # 6 x 6 covariance by rows: element 0 is x, element 21 is rotation about x
        'orientation': MessagePart(
            'pose.pose.orientation', '', 'attitude', '', 'pose.covariance[21]'
        ),
        'velocity': MessagePart(
            'twist.twist.linear', 'm/s', 'vector', 'body', 'twist.covariance[0]'
        ),
        'rates': MessagePart(
            'twist.twist.angular', 'rad/s', 'axial', 'body', 'twist.covariance[21]'
        ),
    },
    'sensor_msgs/msg/Imu': {
        'orientation': MessagePart('orientation', '', 'attitude', '', 'orientation_covariance[0]'),
        'rates': MessagePart(
            'angular_velocity', 'rad/s', 'axial', 'body', 'angular_velocity_covariance[0]'
        ),
        'acceleration': MessagePart(
            'linear_acceleration', 'm/s2', 'vector', 'body', 'linear_acceleration_covariance[0]'
        ),
    },
    'geometry_msgs/msg/PoseStamped': _POSE,
    'geometry_msgs/msg/TwistStamped': {
        'velocity': MessagePart('twist.linear', 'm/s', 'vector', 'body'),
        'rates': MessagePart('twist.angular', 'rad/s', 'axial', 'body'),
    },
    'geometry_msgs/msg/WrenchStamped': {
        'force': MessagePart('wrench.force', 'N', 'vector', 'body'),
        'torque': MessagePart('wrench.torque', 'N m', 'axial', 'body'),
    },
    'geometry_msgs/msg/Vector3Stamped': {
        'vector': MessagePart('vector', 'm/s', 'vector', 'world'),
    },
    'sensor_msgs/msg/BatteryState': {
        'voltage': MessagePart('voltage', 'V'),
        'current': MessagePart('current', 'A'),
        'temperature': MessagePart('temperature', 'degC'),
        'percentage': MessagePart('percentage', '1'),
        # BatteryState counts charge in ampere hours
        'charge': MessagePart('charge', 'C', share=1.0 / 3600.0),
        'capacity': MessagePart('capacity', 'C', share=1.0 / 3600.0),
    },
    'sensor_msgs/msg/Range': {
        'range': MessagePart('range', 'm'),
        'minimum': MessagePart('min_range', 'm'),
        'maximum': MessagePart('max_range', 'm'),
        'field_of_view': MessagePart('field_of_view', 'rad'),
    },
    'sensor_msgs/msg/FluidPressure': {'pressure': MessagePart('fluid_pressure', 'Pa')},
    'sensor_msgs/msg/Illuminance': {'illuminance': MessagePart('illuminance', 'lx')},
    JOINTS: {},
}
ELSEWHERE = ('light/bearing',)  # a vector, but without a unit of its own


def list_targets() -> dict[str, ImportTarget]:
    """Return the topics that an import can write, by relative name."""
    listed = {
        name: ImportTarget(topic.type, topic.frame)
        for name, topic in load_topic_table().topics.items()
        if topic.type in SHAPES and name not in ELSEWHERE
    }
    return listed | EXTRA


def find_target(name: str) -> ImportTarget:
    """Return one target; raise `BadInput` with the known names if it is unknown."""
    targets = list_targets()
    if name not in targets:
        raise unknown_name_error('topic to import into', name, list(targets))
    return targets[name]
