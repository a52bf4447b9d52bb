# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The shipped launches: `fly`, one drone; `fleet`, several; `emulated`, one on emulated hardware.

`DRONE_NODES` says which nodes a drone has, when each starts, and with which parameters.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import share_folder
from lta_config.python_file import run_python_file
from lta_config.settings import Settings
from lta_graph.launch_arguments import (
    DroneArguments,
    EmulatedArguments,
    FleetArguments,
    FlyArguments,
    PacedArguments,
)
from lta_graph.launch_plan import Launch, LaunchProcess, Parameter

LANDING_GRACE = 23.0  # s from SIGINT to SIGTERM: a real drone lands first, which is recorded
VIEWER_GRACE = 1.0  # s from SIGINT to SIGTERM: nothing is lost with a live view
EMULATION_PATIENCE = 60.0  # s that a bridge waits for the emulated hardware, which loads a model
# Where the five drones of a row start, in spacings along map y; the first where that of `fly` does
FLEET_ROW = (0, -1, 1, -2, 2)
LAUNCH_SUFFIX = '.launch.py'
# Arguments that each drone of a fleet has for itself
PER_DRONE = ('robot', 'vehicle', 'gains', 'strategy', 'seed', 'offset_x', 'offset_y', 'live_port')
# Parameters of a simulator or recorder that stand for one drone
DRONE_PARAMETERS = {*PER_DRONE, 'scenario', 'commanded'}


@final
@dataclass(frozen=True, slots=True)
class NodeEntry:
    """
    One node of the table.

    `parameters` name arguments, or properties of the arguments, which the node gets as parameters
    of the same name; `renamed` returns those of another name.
    """

    package: str
    executable: str
    starts: Callable[[FlyArguments], bool]
    parameters: str
    renamed: Callable[[FlyArguments], Mapping[str, Parameter]] = lambda _: {}
    takes_gains: bool = False  # whether it reads the file of the gains
    # All but those for viewers
    on_exit_shutdown: bool = True
    planned: bool = False  # whether its end with status 0 is the planned end of the run
    # Whether it keeps its process: a bridge lands its drone even if the nodes that share one break
    apart: bool = False
    sigterm_timeout: float | None = None  # [s]

    def build_process(self, arguments: FlyArguments) -> LaunchProcess:
        """Return the process of the node."""
        parameters = {name: getattr(arguments, name) for name in self.parameters.split()}
        return LaunchProcess(
            self.package,
            self.executable,
            name=self.executable,
            namespace=f'/{arguments.robot.strip("/")}',
            parameters={**parameters, **self.renamed(arguments)},
            parameter_file=arguments.gains_file if self.takes_gains else '',
            on_exit_shutdown=self.on_exit_shutdown,
            planned=self.planned,
            sigterm_timeout=self.sigterm_timeout,
            shared=arguments.processes == 'one' and not self.apart,
        )


SIMULATOR_ENTRY = NodeEntry(
    'lta_sim',
    'simulator',
    lambda a: a.is_simulated and not a.fleet,
    'time frame_prefix vehicle scenario strategy seed offset_x offset_y commanded wait_for record '
    'topics',
    planned=True,
)
RECORDER_ENTRY = NodeEntry(
    'lta_bridge',
    'recorder',
    lambda a: a.record and not a.fleet,
    'use_sim_time time source replay bag topics queue_size vehicle '
    'scenario strategy commanded seed offset_x offset_y',
    lambda a: {'gains': a.gains_file},
    sigterm_timeout=LANDING_GRACE,
)
DRONE_NODES = (
    SIMULATOR_ENTRY,
    NodeEntry(
        'lta_bridge',
        'player',
        lambda a: a.source == 'replay',
        'time source rate record',
        lambda a: {'bag': a.replay},
        planned=True,
    ),
    NodeEntry(
        'lta_bridge',
        'crazyflie_bridge',
        lambda a: a.source == 'crazyflie',
        'time source frame_prefix vehicle uri command watchdog blind allow_other_commanders',
        lambda a: {'patience': a.uri_patience},
        planned=True,
        apart=True,
        sigterm_timeout=LANDING_GRACE,
    ),
    NodeEntry(
        'lta_control',
        'estimator',
        lambda a: a.estimator,
        'use_sim_time time frame_prefix source vehicle',
    ),
    NodeEntry(
        'lta_control',
        'controller',
        lambda a: a.starts_controller,
        'use_sim_time time frame_prefix source vehicle scenario armed',
        takes_gains=True,
    ),
    NodeEntry(
        'lta_vlc',
        'demodulator',
        lambda a: a.starts_demodulator,
        'use_sim_time time frame_prefix source vehicle',
    ),
    NodeEntry(
        'lta_control',
        'navigator',
        lambda a: a.navigator,
        'use_sim_time time frame_prefix source vehicle strategy scenario commanded',
    ),
    NodeEntry(
        'lta_energy',
        'energy_monitor',
        lambda a: a.energy_monitor,
        'use_sim_time time frame_prefix source vehicle',
        # A Crazyflie measures no current: a model's, off by up to 0.3 A (test_bridge.py),
        # shifts the voltage by 0.15 ohm of that [V]
        lambda a: {'belief.voltage_noise': 0.04 if a.source == 'crazyflie' else 0.01},
    ),
    RECORDER_ENTRY,
    NodeEntry(
        'lta_bridge',
        'live',
        lambda a: a.live,
        'use_sim_time time frame_prefix source',
        lambda a: {'host': a.live_host, 'port': a.live_port},
        on_exit_shutdown=False,
        apart=True,
        sigterm_timeout=VIEWER_GRACE,
    ),
    NodeEntry(
        'lta_bridge',
        'teensy_bridge',
        lambda a: a.light_board,
        'time frame_prefix vehicle',
        lambda a: {'port': a.light_port, 'peaks': a.light_peaks, 'patience': a.light_patience},
        apart=True,
    ),
    NodeEntry(
        'lta_bridge',
        'teleop',
        lambda a: a.teleop,
        'use_sim_time time frame_prefix',
        lambda a: {'device': a.teleop_device},
        apart=True,
    ),
    NodeEntry(
        'lta_bridge',
        'tracker',
        lambda a: a.tracker,
        'use_sim_time time frame_prefix',
        lambda a: {
            'pose': a.tracked_topic,
            'type': a.tracked_type,
            'body_name': a.robot,
            'truth': not a.is_simulated,
        },
        apart=True,
    ),
    NodeEntry(
        'lta_bridge',
        'pilot',
        lambda a: a.pilot,
        'use_sim_time time frame_prefix seed',
        lambda a: {'room': a.pilot_room, 'height': a.pilot_height, 'seconds': a.pilot_seconds},
        planned=True,
        apart=True,
    ),
    NodeEntry(
        'lta_bridge',
        'description',
        lambda a: a.description,
        'use_sim_time time frame_prefix vehicle pose scene map',
        on_exit_shutdown=False,
    ),
)


def list_drone(arguments: FlyArguments) -> list[LaunchProcess]:
    """Return the graph of one drone."""
    nodes = [entry.build_process(arguments) for entry in DRONE_NODES if entry.starts(arguments)]
    return [*nodes, build_rviz(arguments)] if arguments.rviz else nodes


def build_rviz(arguments: FlyArguments) -> LaunchProcess:
    """Return RViz with the shipped view, whose topics are relative to the robot's namespace."""
    return LaunchProcess(
        'rviz2',
        'rviz2',
        name='rviz',
        namespace=f'/{arguments.robot.strip("/")}',
        parameters={'use_sim_time': arguments.use_sim_time},
        words=('-d', str(share_folder() / 'rviz/lta.rviz')),
        on_exit_shutdown=False,
        sigterm_timeout=VIEWER_GRACE,
    )


def list_emulated(arguments: EmulatedArguments) -> list[LaunchProcess]:
    """
    Return the graph of a real drone, and the hardware emulated below it.

    It is one simulated world behind a Crazyflie (CRTP over UDP) and its light board (MAVLink over
    a pseudo terminal).
    """
    options = ('vehicle', 'scenario', 'seed', 'port', 'light_port', 'beacon')
    words = ((f'--{name.replace("_", "-")}', f'{getattr(arguments, name)}') for name in options)
    hardware = LaunchProcess(
        'lta_emulation',
        'emulated_hardware',
        name='emulated_hardware',
        words=tuple(word for pair in words for word in pair),
        planned=True,
    )
    drone = FlyArguments(
        **copy_fields(arguments, DroneArguments),
        source='crazyflie',
        uri=f'udp://127.0.0.1:{arguments.port}',
        uri_patience=EMULATION_PATIENCE,
        light_board=True,
        light_port=arguments.light_port,
        light_patience=EMULATION_PATIENCE,
    )
    return [hardware, *list_drone(drone)]


def list_fleet(arguments: FleetArguments) -> list[LaunchProcess]:
    """
    Return the graphs of several drones in one scene, their one simulator and one recorder.

    It is the graph of `fly` once in each namespace. The drones do not feel each other: they do not
    touch, stir each other's air or stand in each other's light. So each flies exactly as it would
    alone, in lockstep to the last bit of its topics. Whose flight is over stands still until those
    of the others are; then the launch ends.
    """
    robots = [f'{arguments.robot}{k + 1}' for k in range(arguments.n)]
    drones = [
        FlyArguments(
            **copy_fields(arguments, PacedArguments),
            robot=robot,
            vehicle=select_in_turn(arguments.vehicle, k),
            gains=select_in_turn(arguments.gains, k),
            strategy=select_in_turn(arguments.strategy, k),
            seed=arguments.seed + k,
            offset_x=arguments.offset_x + arguments.spacing * (k // 5),
            offset_y=arguments.offset_y + arguments.spacing * FLEET_ROW[k % 5],
            live_port=arguments.live_port + k,
            fleet=True,
            frame_prefix=f'{robot}/',
        )
        for k, robot in enumerate(robots)
    ]
    nodes = [process for drone in drones for process in list_drone(drone)]
    common = [SIMULATOR_ENTRY, *([RECORDER_ENTRY] if arguments.record else [])]
    return [*nodes, *(build_common_process(entry, drones) for entry in common)]


def select_in_turn(values: str, k: int) -> str:
    """Return the value of drone k from one for all, or several that take turns."""
    words = values.split(',')
    return words[k % len(words)]


def build_common_process(entry: NodeEntry, drones: list[FlyArguments]) -> LaunchProcess:
    """Return a node of several drones, whose parameters for one begin with its name."""
    process = entry.build_process(drones[0])
    own = {*DRONE_PARAMETERS, 'frame_prefix'}
    parameters = {name: value for name, value in process.parameters.items() if name not in own}
    parameters['robots'] = ' '.join(drone.robot for drone in drones)
    for drone in drones:
        for name, value in entry.build_process(drone).parameters.items():
            if name in DRONE_PARAMETERS:
                parameters[f'{drone.robot}.{name}'] = value
    return replace(process, namespace='/', parameters=parameters)


def copy_fields(arguments: Settings, model: type[Settings]) -> dict[str, Any]:
    """Return the arguments that a model declares, by name."""
    return {name: getattr(arguments, name) for name in model.model_fields}


FLY = Launch('fly', FlyArguments, list_drone)
EMULATED = Launch('emulated', EmulatedArguments, list_emulated)
FLEET = Launch('fleet', FleetArguments, list_fleet)
LAUNCHES = {launch.name: launch for launch in (EMULATED, FLEET, FLY)}


def find_launch(name: str) -> Launch:
    """
    Return the launch of a shipped name such as `fly`, or of a launch file.

    Raise `BadInput` if there is none, or it cannot be run or defines no launch.
    """
    if name in LAUNCHES:
        return LAUNCHES[name]
    if '/' not in name and not name.endswith(LAUNCH_SUFFIX):
        raise unknown_name_error('launch file', name, list(LAUNCHES))
    path = Path(name)
    if not path.is_file():
        raise BadInput(f'There is no launch file {path}; check the path.')
    launch = getattr(run_python_file(path, 'a launch file'), 'LAUNCH', None)
    if not isinstance(launch, Launch):
        raise BadInput(
            f"'{path}' defines no LAUNCH; start it with ros2 launch, or define one as "
            'docs/add.md shows.'
        )
    return replace(launch, name=name)
