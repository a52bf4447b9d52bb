# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The parameters of this package's nodes."""

from typing import Literal

from lta_bag.provenance import collect_provenance
from lta_bridge.live.origin_gate import LIVE_PORT, LOCAL
from lta_bridge.teleop.steering import TeleopRates
from lta_bridge.teleop.sticks import GamepadLayout
from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import DemodulationSettings

FOREVER = 1e9  # s: the end of any recording
# Place along x, y and z [m], and yaw [rad]
LevelPlace = tuple[float, float, float, float]


class DescriptionSettings(Settings):
    """Parameters of the description node: the vehicle, its scene, and its pose."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    pose: Literal['', 'odom', 'ground_truth/odom'] = setting('', fixed=True)
    """Topic with the pose of base_link to publish on /tf, if no estimator of LTA does."""
    map: bool = setting(False, fixed=True)
    """Whether map is where odom begins, as neither simulator nor tracker says where it is."""
    scene: str = setting('', fixed=True)
    """Scenario, name or file, whose room is drawn; none by default."""


class LiveSettings(Settings):
    """Parameters of the live node."""

    host: str = setting(LOCAL, fixed=True)
    """Address to listen on; 0.0.0.0 also accepts other computers."""
    port: int = setting(LIVE_PORT, low=1, high=65535, fixed=True)
    """TCP port of the live view."""


class TrackerSettings(Settings):
    """Parameters of the tracker node: the tracked topic or frame, and the frames' poses."""

    pose: str = setting('tracker/pose', fixed=True)
    """Topic with the poses of the motion-capture tracker."""
    type: Literal['pose', 'odometry', 'named_poses'] = setting('pose', fixed=True)
    """
    Type of that topic: PoseStamped, Odometry, or NamedPoseArray of
    motion_capture_tracking_interfaces.
    """
    body_name: str = setting('lta1', fixed=True)
    """Name of the drone in a NamedPoseArray."""
    truth: bool = setting(True, fixed=True)
    """Whether to publish ground_truth/odom; not beside a simulator, which does."""
    frame: str = setting('', fixed=True)
    """
    Frame on /tf to take the pose from, relative to its parent frame; empty to use the topic of the
    parameter pose.
    """
    origin: LevelPlace = setting((0.0, 0.0, 0.0, 0.0), fixed=True)
    """Pose of the tracker's frame (z up) in the map: x, y, z in m, yaw in rad."""
    body: LevelPlace = setting((0.0, 0.0, 0.0, 0.0), fixed=True)
    """Pose of the hull centre in the frame of the tracked body: x, y, z in m, yaw in rad."""
    delay: float = setting(0.0, 's', 0.0, 1.0, fixed=True)
    """Smallest delay between the measurement of a pose and the arrival of its message."""


class TeensyBridgeSettings(Settings):
    """Parameters of the light board bridge."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    port: str = setting('/dev/ttyACM0', fixed=True)
    """
    Serial port of the light board, or udp://HOST:PORT to listen on; append ?from=ADDRESS to accept
    only that sender.
    """
    peaks: bool = setting(False, fixed=True)
    """
    Whether the light board itself detects the frequency peaks; then no demodulator is needed.
    """
    threshold: float = setting(DemodulationSettings().threshold, '1', 1.0, 1000.0)
    """Smallest signal-to-noise ratio at which a photodiode is used (only with peaks:=true)."""
    prior: LampPrior = setting(LampPrior())
    """Assumed position of the lamp until it is first seen (only with peaks:=true)."""
    patience: float = setting(0.0, 's', 0.0, 600.0, fixed=True)
    """How long the node waits for the serial port to appear before it fails."""
    autostart: bool = setting(True, fixed=True)
    """Whether the node configures and activates itself at the start."""


class CrazyflieBridgeSettings(Settings):
    """Which Crazyflie to connect to, and how to command it."""

    uri: str = setting('radio://0/80/2M/E7E7E7E7E7', fixed=True)
    """URI of the Crazyflie."""
    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    crazyflie: str = setting('', fixed=True)
    """
    Crazyflie file with motor wiring, parameters and flight limits, by name or path; empty for the
    one of the vehicle.
    """
    command: Literal['', 'setpoint', 'motors'] = setting('', fixed=True)
    """
    Command mode: setpoint (the controller of the firmware flies) or motors (duties for LTA's app
    in the firmware). Empty for the mode in the Crazyflie file.
    """
    blind: bool = setting(False, fixed=True)
    """
    Whether the drone may be armed without a position estimate; then no limit of height and
    distance ends its flight.
    """
    allow_other_commanders: bool = setting(False, fixed=True)
    """
    Whether nodes of other names than in the topic table may publish motors, setpoints or teleop
    commands, such as your own controller; otherwise they refuse arming and end the flight.
    """
    watchdog: Literal['setpoint', 'always', 'never'] = setting('setpoint', fixed=True)
    """
    When the armed drone stops and locks its motors until it is restarted, if it receives no
    message from the bridge for 1 s: setpoint (in this command mode; with motor duties, LTA's app
    stops them after 0.2 s), always or never.
    """
    patience: float = setting(0.0, 's', 0.0, 600.0, fixed=True)
    """Time to wait at the start until a program listens at a udp:// URI."""
    autostart: bool = setting(True, fixed=True)
    """Whether the node configures and activates itself at the start; it never arms the drone."""


class TeleopSettings(Settings):
    """Parameters of the teleop node: device, axes, buttons and rates."""

    device: str = setting('joy', fixed=True)
    """
    Input device: keyboard (of this terminal), a gamepad such as /dev/input/js0, joy (Joy
    messages), or cmd_vel (TwistStamped messages of a program).
    """
    rates: TeleopRates = setting(TeleopRates())
    """Speed and rates commanded at full deflection of the sticks."""
    layout: GamepadLayout = setting(GamepadLayout())
    """Numbers of the axes and buttons of the gamepad."""


class PilotSettings(Settings):
    """What is flown, and where."""

    seconds: float = setting(60.0, 's', 1.0, 600.0, fixed=True)
    """Time in which sticks move."""
    room: float = setting(6.0, 'm', 1.0, 100.0, fixed=True)
    """Way across the place that the drone needs: sticks rest where it could coast further."""
    x: float = setting(0.0, 'm', -1000.0, 1000.0, fixed=True)
    """Place in the map, along x."""
    y: float = setting(0.0, 'm', -1000.0, 1000.0, fixed=True)
    """Place in the map, along y."""
    height: float = setting(1.2, 'm', 0.1, 100.0, fixed=True)
    """Height of the hull centre at the place, above the floor."""
    seed: int = setting(1, low=0, high=2**31 - 1, fixed=True)
    """Random seed of the sticks."""


class RobotOrigin(Settings):
    """The origin of a robot's data to store in the bag."""

    vehicle: str = setting('gtmab', fixed=True)
    """Vehicle name or file."""
    scenario: str = setting('lamp_room', fixed=True)
    """Scenario name or file."""
    gains: str = setting('gtmab', fixed=True)
    """Name or file of the controller's gains."""
    strategy: str = setting('homing', fixed=True)
    """Navigation strategy."""
    commanded: bool = setting(False, fixed=True)
    """Whether the drone flies by actions, whose goals are not in the bag."""
    seed: int = setting(1, low=0, high=2**31 - 1, fixed=True)
    """Random seed."""
    offset_x: float = setting(0.0, 'm', -1e3, 1e3, fixed=True)
    """Distance of the start position to the east of that in the scenario."""
    offset_y: float = setting(0.0, 'm', -1e3, 1e3, fixed=True)
    """Distance of the start position to the north of that in the scenario."""

    def to_provenance(self, *, lockstep: bool) -> dict[str, str]:
        """Return the origin as it is stored in the bag."""
        moved = {'offset_x': self.offset_x, 'offset_y': self.offset_y}
        return collect_provenance(
            self.vehicle,
            self.scenario,
            self.gains,
            strategy=self.strategy,
            seed=str(self.seed),
            time='lockstep' if lockstep else 'realtime',
            **({'commanded': 'true'} if self.commanded else {}),
            **{name: str(value) for name, value in moved.items() if value},
        )


class RecorderSettings(RobotOrigin):
    """Parameters of the recorder node."""

    bag: str = setting('runs/bag', fixed=True)
    """Folder of the bag; must be empty or not exist yet."""
    robots: str = setting('', fixed=True)
    """
    Namespaces of the robots to record, separated by spaces; empty for that of the recorder. With
    several robots, parameters such as lta2.seed give the origin of each.
    """
    replay: str = setting('', fixed=True)
    """
    Path of the bag that is replayed; the new bag copies from it whether the data was simulated or
    measured (only with source:=replay).
    """
    topics: str = setting('', fixed=True)
    """
    Topics to record: relative or absolute names, separated by spaces; 'all' for every topic of the
    graph; empty for those marked as recorded in docs/topics.md.
    """
    queue_size: float = setting(64.0, 'MB', 1.0, 1e5, fixed=True)
    """Memory limit for messages that wait to be written to the disk."""


class PlayerSettings(Settings):
    """Parameters of the player node."""

    bag: str = setting('', fixed=True)
    """The bag: a rosbag2 folder or an .mcap file."""
    robot: str = setting('', fixed=True)
    """
    Namespace of the robot in the bag to play; empty for the player's own namespace, or for the
    only robot of the bag.
    """
    nodes: str = setting('', fixed=True)
    """
    Nodes to run again, separated by spaces; their recorded messages are not played. If empty, all
    run again.
    """
    roles: str = setting('', fixed=True)
    """
    Nodes whose recorded messages are played in addition to those of the vehicle, separated by
    spaces.
    """
    rate: float = setting(1.0, low=1e-3, high=1e6, fixed=True)
    """Playback speed in real time: seconds of the bag per second; no effect in lockstep."""
    start: float = setting(0.0, 's', 0.0, FOREVER, fixed=True)
    """Start of the section to play, counted from the first message."""
    end: float = setting(FOREVER, 's', 0.0, FOREVER, fixed=True)
    """End of the section to play, counted from the first message."""
    answers: str = setting('', fixed=True)
    """Folder of a new bag for what the nodes that run again publish; empty for no bag."""
    patience: float = setting(30.0, 's', 0.1, 3600.0, fixed=True)
    """How long to wait for the nodes to start, and in lockstep for an answer."""
    record: bool = setting(False, fixed=True)
    """Whether playback waits until a recorder runs."""


def check_playback(settings: PlayerSettings) -> None:
    """Raise `BadInput` without a bag."""
    if not settings.bag:
        raise BadInput('The player has no bag to play; name one, as in bag:=runs/flight/bag.')
