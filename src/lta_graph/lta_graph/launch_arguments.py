# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Arguments of the shipped launches, for `lta launch`, `ros2 launch` and the generated page."""

from typing import Literal

from lta_config.files import find_file
from lta_config.settings import setting, Settings


class GraphArguments(Settings):
    """Arguments of every launch."""

    scenario: str = setting('lamp_room')
    """Scenario: a shipped name, or the path of a file."""
    processes: Literal['many', 'one'] = setting('many')
    """
    Whether every node has a process of its own (many), or all nodes share one that needs less
    computing (one); nodes that drive a device, and the live view, keep their own.
    """
    record: bool = setting(True)
    """Whether to record a bag."""
    bag: str = setting('runs/bag')
    """Folder of the bag; it must not exist yet."""
    topics: str = setting('')
    """Topics to record, separated by spaces, or all. Empty: those that topics.yaml marks."""
    params_file: str = setting('')
    """
    YAML file of parameters, as ROS reads it: for a node below /**/NAME, for all below /**. Its
    values win over those of the launch.
    """
    queue_size: float = setting(64.0)
    """Memory for messages that wait for a slow disk, in MB."""
    live: bool = setting(False)
    """Whether to show the flight live in Foxglove."""
    live_host: str = setting('127.0.0.1')
    """Address of the live view; 0.0.0.0 accepts connections from other machines."""


class PacedArguments(GraphArguments):
    """Arguments of a launch whose pace can be chosen."""

    time: Literal['realtime', 'lockstep'] = setting('realtime')
    """
    Time mode: realtime runs at the pace of the wall clock, lockstep as fast as the nodes answer.
    """


class DroneArguments(GraphArguments):
    """Arguments of a launch of one drone."""

    vehicle: str = setting('gtmab')
    """Vehicle: a shipped name, or the path of a file."""
    strategy: str = setting('homing')
    """Navigation strategy: bag, des, dga, homing, or a file such as ./mine.py."""
    commanded: bool = setting(False)
    """
    Whether the drone waits on the ground for the actions take_off, go_to_lamp, go_to_pose,
    follow_path and land; needs strategy:=homing. The flight ends by Ctrl-C.
    """
    seed: int = setting(1)
    """Random seed."""
    command: str = setting('')
    """Commands for a Crazyflie: setpoint or motors. Empty: as in its Crazyflie file."""
    light_peaks: bool = setting(False)
    """Whether the light board demodulates the lamp itself; then no demodulator node runs."""
    live_port: int = setting(8765)
    """Port of the live view."""
    rviz: bool = setting(False)
    """Whether to show the drone in RViz, which must be installed."""


class EmulatedArguments(DroneArguments):
    """Arguments of `emulated`."""

    port: int = setting(19850)
    """UDP port of the emulated Crazyflie."""
    light_port: str = setting('lta_light_board')
    """Name of the light board's pseudo terminal."""
    beacon: float = setting(0.0)
    """With light_peaks:=true, the lamp's frequency in Hz."""


class FleetArguments(PacedArguments):
    """Arguments of `fleet`."""

    n: int = setting(2, low=1, high=10)
    """Number of drones, 1 to 10."""
    robot: str = setting('lta')
    """Namespace of each drone, before its number."""
    vehicle: str = setting('gtmab')
    """Vehicle: a shipped name, or the path of a file; several, as a,b, take turns."""
    gains: str = setting('gtmab')
    """Gains of the controllers: a shipped name, or a file; several, as a,b, take turns."""
    strategy: str = setting('homing')
    """Navigation strategy: bag, des, dga, homing, or a file; several, as a,b, take turns."""
    seed: int = setting(1)
    """Random seed of the first drone; each next drone has the next."""
    offset_x: float = setting(0.0)
    """Offset of the first start from the scenario's along map x, in metres."""
    offset_y: float = setting(0.0)
    """Offset of the first start from the scenario's along map y, in metres."""
    spacing: float = setting(1.5)
    """Distance between two starts along y, and from the sixth drone on along x, in metres."""
    live_port: int = setting(8765)
    """Port of the live view of the first drone; the others have the ports that follow."""


class FlyArguments(DroneArguments, PacedArguments):
    """Arguments of `fly`, and what follows from them."""

    robot: str = setting('lta1')
    """Namespace of the drone."""
    source: Literal['sim', 'replay', 'crazyflie'] = setting('sim')
    """Where the vehicle comes from: the simulator, a recording or a real Crazyflie."""
    uri: str = setting('radio://0/80/2M/E7E7E7E7E7')
    """With source:=crazyflie, its URI: radio, usb or udp."""
    uri_patience: float = setting(0.0)
    """With source:=crazyflie and a udp URI, seconds to wait until a program listens there."""
    watchdog: Literal['setpoint', 'always', 'never'] = setting('setpoint')
    """
    With source:=crazyflie, when its firmware stops the motors until a restart if it receives
    nothing for 1 s: only with command setpoint, always or never.
    """
    blind: bool = setting(False)
    """
    With source:=crazyflie, whether it may be armed without a position estimate; then no limit of
    height and distance ends its flight.
    """
    allow_other_commanders: bool = setting(False)
    """
    With source:=crazyflie, whether nodes of other names than in the topic table may command the
    drone, such as your own controller; otherwise they refuse arming and end the flight.
    """
    replay: str = setting('')
    """With source:=replay, the bag to replay."""
    rate: float = setting(1.0)
    """With source:=replay in real time, the speed: seconds of the bag per second."""
    offset_x: float = setting(0.0)
    """Offset of the start position from the scenario's along map x, in metres."""
    offset_y: float = setting(0.0)
    """Offset of the start position from the scenario's along map y, in metres."""
    gains: str = setting('gtmab')
    """Gains of the controller: a shipped name, or a file."""
    light_board: bool = setting(False)
    """Whether the light comes from a real light board; not with source:=sim."""
    light_port: str = setting('/dev/ttyACM0')
    """With light_board:=true, its serial port, or udp://HOST:PORT to listen on."""
    light_patience: float = setting(0.0)
    """With light_board:=true, seconds to wait until the port exists."""
    teleop: bool = setting(False)
    """Whether a person with a gamepad, or a program by cmd_vel, can take control."""
    teleop_device: str = setting('joy')
    """
    With teleop:=true, the gamepad: /dev/input/js0, joy for Joy messages, or cmd_vel for velocities
    that a program sends.
    """
    tracker: bool = setting(False)
    """
    Whether an external tracking system provides tracker/odom, by which the drone holds places, and
    map -> odom; of a real drone also ground_truth/odom.
    """
    tracker_pose: str = setting('')
    """
    With tracker:=true, the topic with its poses. Empty: tracker/pose, or in simulation a perfect
    tracker.
    """
    tracker_type: Literal['pose', 'odometry', 'named_poses'] = setting('pose')
    """
    With tracker:=true, the type of that topic: PoseStamped, Odometry, or the NamedPoseArray of
    motion_capture_tracking, in which the drone is named as its namespace.
    """
    pilot: bool = setting(False)
    """
    Whether to fly by itself what calibrates the vehicle, and land, as "lta tests fly" does; with
    commanded:=true tracker:=true teleop:=true.
    """
    pilot_room: float = setting(6.0)
    """With pilot:=true, the way across the origin of map that the drone needs, in metres."""
    pilot_height: float = setting(1.2)
    """With pilot:=true, the height of the flight, in metres."""
    pilot_seconds: float = setting(60.0)
    """With pilot:=true, the seconds in which sticks move."""
    simulator: bool = setting(True)
    """With source:=sim, whether to start the simulator."""
    estimator: bool = setting(True)
    """Whether to start the estimator; false for one of your own."""
    controller: bool = setting(True)
    """Whether to start the controller; false for one of your own."""
    demodulator: bool = setting(True)
    """Whether to start the demodulator; false for one of your own."""
    navigator: bool = setting(True)
    """Whether to start the navigator; false for one of your own."""
    energy_monitor: bool = setting(True)
    """Whether to start the energy monitor; false for one of your own."""
    description: bool = setting(True)
    """Whether to publish robot_description, /tf_static and the scene for RViz."""
    frame_prefix: str = setting('')
    """Prefix of all frames but map, such as lta1/, for several drones."""
    fleet: bool = setting(False)
    """Whether the drone is one of several, whose launch starts one simulator and one recorder."""

    @property
    def is_simulated(self) -> bool:
        """Whether this launch simulates the drone."""
        return self.source == 'sim' and self.simulator

    @property
    def use_sim_time(self) -> bool:
        """Return False for a real drone, which flies by the time of day; others tell /clock."""
        return self.source != 'crazyflie'

    @property
    def is_tracked_perfectly(self) -> bool:
        """Whether the simulator plays the tracker."""
        return self.is_simulated and not self.tracker_pose

    @property
    def tracked_topic(self) -> str:
        """Return the topic with the poses of the drone."""
        played = 'ground_truth/odom' if self.is_tracked_perfectly else 'tracker/pose'
        return self.tracker_pose or played

    @property
    def tracked_type(self) -> str:
        """Return the type of that topic."""
        return 'odometry' if self.is_tracked_perfectly else self.tracker_type

    @property
    def armed(self) -> bool:
        """Whatever else plays the vehicle arms the controller when its drone is armed."""
        return self.is_simulated or self.source == 'replay'

    @property
    def starts_controller(self) -> bool:
        """Return False for a drone that flies its own controller by setpoints."""
        return self.controller and self.command != 'setpoint'

    @property
    def starts_demodulator(self) -> bool:
        """Return False for a light board that demodulates."""
        return self.demodulator and not self.light_peaks

    @property
    def wait_for(self) -> str:
        """
        Return the nodes that the simulator waits for, separated by spaces.

        In real time they are those that start here, in lockstep all of the topic table. What the
        description publishes once has to be in the bag of a short flight as well.
        """
        nodes = {
            'estimator': self.estimator,
            'controller': self.starts_controller,
            'demodulator': self.starts_demodulator,
            'navigator': self.navigator,
            'energy_monitor': self.energy_monitor,
        }
        started = [name for name, starts in nodes.items() if starts]
        names = ['default'] if self.time == 'lockstep' else started
        return ' '.join([*names, 'description'] if self.description else names)

    @property
    def pose(self) -> str:
        """Return the pose to publish on /tf where our estimator, which does it, does not run."""
        return '' if self.estimator else 'odom'

    @property
    def scene(self) -> str:
        """Only of a simulated drone it is known that it flies in the room of its scenario."""
        return self.scenario if self.is_simulated else ''

    @property
    def map(self) -> bool:
        """Whether nobody knows where a real drone is: then map is where it starts."""
        return self.source == 'crazyflie' and not self.tracker

    @property
    def gains_file(self) -> str:
        """Return the path of the gains."""
        return str(find_file('gains', self.gains))
