# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check the nodes of a launch plan before any of them starts."""

from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final, TypeVar

from lta_bridge.crazyflie.safety import LEAVE
from lta_bridge.parameters import (
    check_playback,
    CrazyflieBridgeSettings,
    PlayerSettings,
    RecorderSettings,
)
from lta_bridge.playback.recording import open_recording
from lta_bridge.teensy.port import require_port
from lta_bridge.teleop.steering import check_time_mode
from lta_bridge.teleop.sticks import require_gamepad
from lta_config.constants import AIR_DENSITY
from lta_config.errors import BadInput
from lta_config.files import find_file, format_error, validate_content
from lta_config.limits import limit_memory
from lta_config.schema.crazyflie_file import find_crazyflie
from lta_config.settings import Settings
from lta_config.topics import load_topic_table, select_topics
from lta_control.laws import check_onboard_law
from lta_control.strategies import check_route, find_navigation_strategy
from lta_flight.flight_spec import check_lamp_frequency
from lta_graph.launch_plan import LaunchPlan
from lta_model.scenario import load_scenario, offset_start
from lta_model.vehicle import load_vehicle
from lta_report.results_folder import check_creatable
from lta_sim import scene_model
from lta_vlc.settings import DemodulationSettings
from pydantic import ValidationError

OURS = 'lta_'
CONTROLLER, DEMODULATOR, NAVIGATOR = 'controller', 'demodulator', 'navigator'
BRIDGE = ('lta_bridge', 'crazyflie_bridge')
LANDING = LEAVE + 5.0  # s to land and then to close the link
SEEDS = range(2**31)  # non-negative int32


def check_plan(plan: LaunchPlan) -> None:
    """
    Reject what our nodes would reject: vehicle, scenario, strategy, seed, bag or device.

    Also reject what no node can detect alone: a lamp outside the demodulator's search window, a
    bridge that would be stopped before it has landed its drone, and two controllers of one drone.

    Raises
    ------
    BadInput
        The sentence with which the node would exit.

    """
    # First: a vehicle that flies by its own firmware may have no law for our controller
    check_controllers(plan)
    for process in plan.processes:
        if process.package.startswith(OURS):
            for parameters in split_by_robot(process.parameters):
                check_parameters(parameters, controls=process.executable == CONTROLLER)
            # A parameter file, which is not read here, may set others
            if not process.parameter_file:
                robot = process.namespace.strip('/')
                check_node(process.executable, robot, process.parameters)
    check_names(plan)
    check_launched_demodulators(plan)
    check_landing_time(plan)


def check_names(plan: LaunchPlan) -> None:
    """Reject two nodes of one name, which would answer in each other's place."""
    counts = Counter((process.namespace, process.name) for process in plan.processes)
    for (namespace, name), count in counts.items():
        if count > 1:
            raise BadInput(
                f"{count} nodes have the name '{namespace.rstrip('/')}/{name}'; give each robot a "
                'namespace of its own, or each node another name.'
            )


def check_landing_time(plan: LaunchPlan) -> None:
    """Reject a bridge that does not get the time to land its drone after Ctrl-C."""
    for process in plan.processes:
        timeout = process.sigterm_timeout
        if (process.package, process.executable) == BRIDGE and (timeout or 0.0) < LANDING:
            setting = (
                'no sigterm_timeout' if timeout is None else f'a sigterm_timeout of {timeout:g} s'
            )
            raise BadInput(
                f'The node {plan.label(process)} has {setting}, but lands its drone for up to '
                f'{LANDING:g} s after Ctrl-C; give it at least sigterm_timeout={LANDING:.1f} '
                'in the launch file.'
            )


def check_controllers(plan: LaunchPlan) -> None:
    """Reject our controller beside a Crazyflie that its own firmware controls, by setpoints."""
    controllers = {
        process.namespace: plan.label(process)
        for process in plan.processes
        if process.package.startswith(OURS) and process.executable == CONTROLLER
    }
    for process in plan.processes:
        # The controller would never be armed, and a take-off would end as a fault
        if (process.package, process.executable) != BRIDGE or process.namespace not in controllers:
            continue
        if not process.parameter_file:  # which is not read here
            settings = validate_settings(
                CrazyflieBridgeSettings, process.executable, process.parameters
            )
            name = load_vehicle(settings.vehicle).file.name
            file = find_crazyflie(settings.vehicle, name, settings.crazyflie)
            if (settings.command or file.command) == 'setpoint':
                raise BadInput(
                    f'The Crazyflie of {name} is commanded by setpoints, which its own firmware '
                    f'follows, but {controllers[process.namespace]} is to start too; add '
                    'command:=setpoint or controller:=false.'
                )


def check_parameters(values: Mapping[str, object], controls: bool) -> None:
    """
    Reject parameters that one node would reject.

    `values`: its parameters by name. `controls`: whether it is the controller, which supports only
    some control laws.
    """
    density, scenario = AIR_DENSITY, None
    if isinstance(name := values.get('scenario'), str):
        scenario = offset_start(load_scenario(name), *start_offset(values))
        # Evaluated for its check: raises BadInput for invalid lights
        _ = scenario.light_field
        density = scenario.air.density
    if isinstance(name := values.get('vehicle'), str):
        vehicle = load_vehicle(name, density)
        _ = vehicle.hover_duty
        if controls:
            check_onboard_law(vehicle)
        if scenario is not None:
            scene_model.check_scene(vehicle, scenario)
    if isinstance(name := values.get('strategy'), str):
        check_route(find_navigation_strategy(name), 1 if scenario is None else len(scenario.route))
    # Not isinstance: true is an int in Python, but not for ROS
    if 'seed' in values and not (type(values['seed']) is int and values['seed'] in SEEDS):
        raise BadInput(
            f'The seed is {values["seed"]}, but must be a whole number from 0 to {SEEDS[-1]}.'
        )


def check_launched_demodulators(plan: LaunchPlan) -> None:
    """Reject a scene whose lamp the demodulator of the same robot does not search for."""
    ours = {
        (process.namespace, process.executable): process
        for process in plan.processes
        if process.package.startswith(OURS)
    }
    for (namespace, executable), process in ours.items():
        listener = ours.get((namespace, DEMODULATOR))
        scenario = process.parameters.get('scenario')
        # Only a navigator with its own demodulator can be checked
        if executable != NAVIGATOR or listener is None or not isinstance(scenario, str):
            continue
        if listener.parameter_file:  # its settings are in the file, which is not read here
            continue
        own = listener.parameters
        parameters = {name: own[name] for name in DemodulationSettings.model_fields if name in own}
        check_lamp_frequency(
            load_scenario(scenario),
            validate_content(DemodulationSettings, parameters, 'the settings of demodulator'),
        )


def split_by_robot(values: Mapping[str, object]) -> list[dict[str, object]]:
    """Return the parameters of the node itself, and those of each robot of a recorder."""
    by_robot: dict[str, dict[str, object]] = {}
    for name, value in values.items():
        # A recorder's parameters for one robot are named `lta1.scenario`
        robot, _, own = name.rpartition('.')
        by_robot.setdefault(robot, {})[own] = value
    return list(by_robot.values())


def start_offset(values: Mapping[str, object]) -> tuple[float, float]:
    """Return the offset of the start from a node's parameters; 0 if it is not a number."""
    x, y = (values.get(name) for name in ('offset_x', 'offset_y'))
    return x if isinstance(x, float) else 0.0, y if isinstance(y, float) else 0.0


Values = Mapping[str, object]
Model = TypeVar('Model', bound=Settings)


def check_node(executable: str, robot: str, values: Values) -> None:
    """
    Reject what a node of LTA's own would reject by itself.

    Parameters
    ----------
    executable : str
        The program of the node, such as 'recorder'; most have no check here.
    robot : str
        Its namespace, without slashes.
    values : mapping
        Its parameters by name.

    Raises
    ------
    BadInput
        The sentence with which the node would exit.

    """
    if (check := NODE_CHECKS.get(executable)) is not None:
        check(robot, values)


def check_recorder(robot: str, values: Values) -> None:
    """Reject settings, topics and a folder that the recorder would reject."""
    settings = validate_settings(RecorderSettings, 'recorder', values)
    check_creatable(Path(settings.bag))
    select_topics(settings.topics, settings.robots.split() or [robot], load_topic_table())
    find_file('gains', settings.gains)


def check_player(robot: str, values: Values) -> None:
    """Reject settings and a bag that the player would reject."""
    settings = validate_settings(PlayerSettings, 'player', values)
    check_playback(settings)
    # A damaged bag may declare huge sizes
    with limit_memory():
        open_recording(Path(settings.bag), settings.robot, load_topic_table(), robot)


def check_crazyflie_bridge(_: str, values: Values) -> None:
    """Reject settings and a URI that the bridge of a Crazyflie would reject."""
    settings = validate_settings(CrazyflieBridgeSettings, 'crazyflie_bridge', values)
    # Imported late: cflib takes a second
    from lta_bridge.crazyflie.cflib_link import check_uri

    check_uri(settings.uri)


def check_teensy_bridge(_: str, values: Values) -> None:
    """Reject a missing port of the light board, unless the bridge is to wait for it."""
    port = values.get('port')
    if isinstance(port, str) and not values.get('patience'):
        require_port(port)


def check_teleop(_: str, values: Values) -> None:
    """Reject lockstep and a missing gamepad."""
    check_time_mode(lockstep=values.get('time') == 'lockstep')
    if isinstance(device := values.get('device'), str):
        require_gamepad(device)


def validate_settings(model: type[Model], node: str, values: Values) -> Model:
    """Return the parameters of a node that belong to its settings; raise `BadInput` as it does."""
    own = {name: values[name] for name in model.model_fields if name in values}
    try:
        return model.model_validate(own)
    except ValidationError as error:
        raise BadInput(f'{node}: parameter {format_error(error)}') from None


NODE_CHECKS: Final[Mapping[str, Callable[[str, Values], None]]] = {
    'recorder': check_recorder,
    'player': check_player,
    'crazyflie_bridge': check_crazyflie_bridge,
    'teensy_bridge': check_teensy_bridge,
    'teleop': check_teleop,
}
