"""Check what single nodes of a launch would reject: bags, topics, URIs and devices."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final, TypeVar

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
from lta_config.errors import BadInput
from lta_config.files import find_file, format_error
from lta_config.limits import limit_memory
from lta_config.settings import Settings
from lta_config.topics import load_topic_table, select_topics
from lta_report.results_folder import check_creatable
from pydantic import ValidationError

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
    from lta_bridge.crazyflie.links import check_uri

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
