"""
The shipped launches: `fly`, one drone; `pair`, two; `emulated`, one on emulated hardware.

`DRONE_NODES` says which nodes a drone has, when each starts, and with which parameters.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, final

from lta_config.settings import setting, Settings
from lta_graph.launch_arguments import (
    DroneArguments,
    EmulatedArguments,
    FlyArguments,
    PacedArguments,
)
from lta_graph.launch_plan import Launch, LaunchProcess, Parameter
from pydantic import create_model

LANDING_GRACE = 23.0  # s from SIGINT to SIGTERM: a real drone lands first, which is recorded
VIEWER_GRACE = 1.0  # s from SIGINT to SIGTERM: nothing is lost with a live view
EMULATION_PATIENCE = 60.0  # s that a bridge waits for the emulated hardware, which loads a model
FLEET_SPACING = 2.0  # m between the starts of two drones of a fleet
# Arguments that each drone of a fleet has for itself
PER_DRONE = ('robot', 'vehicle', 'gains', 'strategy', 'seed', 'offset_x', 'offset_y', 'live_port')


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


RECORDER = NodeEntry(
    'lta_bridge',
    'recorder',
    lambda a: a.record and a.recorder,
    'use_sim_time time source replay bag topics split_size split_duration queue_size vehicle '
    'scenario strategy commanded seed offset_x offset_y',
    lambda a: {'gains': a.gains_file},
    sigterm_timeout=LANDING_GRACE,
)
DRONE_NODES = (
    NodeEntry(
        'lta_sim',
        'simulator',
        lambda a: a.is_simulated,
        'time frame_prefix vehicle scenario strategy seed offset_x offset_y commanded wait_for '
        'record topics clock peers',
        planned=True,
    ),
    NodeEntry(
        'lta_bridge',
        'player',
        lambda a: a.source == 'replay',
        'time source rate loop paused record',
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
        # A commanded flight stays at its lamp; others end there
        lambda a: {'homing.brake': a.commanded},
    ),
    NodeEntry(
        'lta_energy',
        'energy_monitor',
        lambda a: a.energy_monitor,
        'use_sim_time time frame_prefix source vehicle',
        # A Crazyflie measures no current: a model's, off by up to 0.3 A (test_consumption.py),
        # shifts the voltage by 0.15 ohm of that [V]
        lambda a: {'belief.voltage_noise': 0.04 if a.source == 'crazyflie' else 0.01},
    ),
    RECORDER,
    NodeEntry(
        'lta_bridge',
        'live',
        lambda a: a.live,
        'use_sim_time time frame_prefix source vehicle scenario',
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
        'time frame_prefix',
        lambda a: {'pose': a.tracker_pose},
        apart=True,
    ),
    NodeEntry(
        'lta_bridge',
        'description',
        lambda a: a.description,
        'use_sim_time time frame_prefix vehicle pose scene',
        on_exit_shutdown=False,
    ),
)


def list_drone(arguments: FlyArguments) -> list[LaunchProcess]:
    """Return the graph of one drone."""
    return [entry.build_process(arguments) for entry in DRONE_NODES if entry.starts(arguments)]


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


def build_fleet(name: str, count: int) -> Launch:
    """
    Return the launch of several drones in one scene, one bag and one /clock.

    It starts the graph of `fly` once in each namespace, and one recorder. The drones do not feel
    each other: they do not touch, stir each other's air or stand in each other's light. So each
    flies exactly as it would alone, in lockstep to the last bit of its topics. They are kept
    within 0.1 s of each other in time, and the first one's simulator tells /clock for all. Whose
    flight is over stands still until those of the others are; then the launch ends.
    """
    first = FlyArguments()
    fields: dict[str, Any] = {}
    for k in range(count):
        defaults = {
            'robot': f'lta{k + 1}',
            'seed': first.seed + k,
            'offset_y': first.offset_y - FLEET_SPACING * k,
            'live_port': first.live_port + k,
        }
        for each in PER_DRONE:
            info = FlyArguments.model_fields[each]
            default = defaults.get(each, info.default)
            about = f'Drone {k + 1}: {info.description}'
            fields[f'{each}{k + 1}'] = (info.annotation, setting(default, about))
    model = create_model('FleetArguments', __base__=PacedArguments, **fields)
    return Launch(name, model, partial(list_fleet, count=count))


def list_fleet(arguments: PacedArguments, count: int) -> list[LaunchProcess]:
    """Return the graphs of several drones, and their recorder."""
    own = [
        {name: getattr(arguments, f'{name}{k + 1}') for name in PER_DRONE} for k in range(count)
    ]
    robots = [each['robot'] for each in own]
    drones = [
        FlyArguments(
            **copy_fields(arguments, PacedArguments),
            **each,
            recorder=False,
            clock=k == 0,
            peers=' '.join(robots[:k] + robots[k + 1 :]),
            frame_prefix=f'{robots[k]}/',
        )
        for k, each in enumerate(own)
    ]
    processes = [process for drone in drones for process in list_drone(drone)]
    return [*processes, build_recorder(drones)] if arguments.record else processes


def build_recorder(drones: list[FlyArguments]) -> LaunchProcess:
    """Return the recorder of several drones, which gets the origin of each."""
    origin = {*PER_DRONE, 'scenario', 'commanded'}
    process = RECORDER.build_process(drones[0])
    parameters = {name: value for name, value in process.parameters.items() if name not in origin}
    parameters['robots'] = ' '.join(drone.robot for drone in drones)
    for drone in drones:
        for name, value in RECORDER.build_process(drone).parameters.items():
            if name in origin:
                parameters[f'{drone.robot}.{name}'] = value
    return replace(process, namespace='/', parameters=parameters)


def copy_fields(arguments: Settings, model: type[Settings]) -> dict[str, Any]:
    """Return the arguments that a model declares, by name."""
    return {name: getattr(arguments, name) for name in model.model_fields}


FLY = Launch('fly', FlyArguments, list_drone)
EMULATED = Launch('emulated', EmulatedArguments, list_emulated)
PAIR = build_fleet('pair', 2)
