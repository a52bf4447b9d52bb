"""What to replay: which nodes, on which bag, with which of their parameters changed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, final

from lta_bridge.playback.node_selection import (
    list_answering_roles,
    list_supporting_roles,
    NodeSelection,
    select_nodes,
)
from lta_bridge.playback.settings import FOREVER
from lta_config.errors import BadInput, unknown_name
from lta_config.files import find_file
from lta_config.parameter_override import parse_assignment, parse_quantity
from lta_config.quantity import Quantity
from lta_config.topics import load_topic_table
from lta_control.strategies import find_strategy
from lta_data.bag.recorded_flight import RecordedFlight
from lta_graph.launch_file import LaunchPlan, load_plan
from lta_graph.launch_node import format_ros_yaml, LaunchProcess
from lta_model.vehicle import load_vehicle

ROBOT = 'lta1'  # where the bag has no namespace
OWNERS = {  # whose parameters they are, that `lta simulate --set` calls by these names
    'mission': ('navigator', ''),
    'reserve': ('navigator', 'reserve.'),
    'estimator': ('estimator', ''),
    'demodulator': ('demodulator', ''),
    'prior': ('demodulator', 'prior.'),
    'energy_monitor': ('energy_monitor', ''),
}
VEHICLE, STRATEGY, LAMP_ROOM = 'gtmab', 'bag', 'lamp_room'  # where the bag does not tell


@final
@dataclass(frozen=True, slots=True)
class ReplayRequest:
    """
    A replay as it was asked for.

    Attributes
    ----------
    bag : Path
        The recording.
    nodes : tuple of str
        What is run again.
    settings : mapping of str to mapping
        Changed parameters, by node and name.
    vehicle, gains, strategy : str or None
        Instead of the recording's own.
    rate : float or None
        Bag seconds a wall second; None for lockstep.
    start, end : float
        The section. [s]

    """

    bag: Path
    nodes: tuple[str, ...]
    settings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    vehicle: str | None = None
    gains: str | None = None
    strategy: str | None = None
    rate: float | None = None
    start: float = 0.0
    end: float = FOREVER

    @property
    def node_selection(self) -> NodeSelection:
        """Who is run, and what is played."""
        table = load_topic_table()
        return select_nodes(table, self.nodes, list_supporting_roles(table, self.nodes))

    @property
    def changes(self) -> list[str]:
        """What is not as it was recorded, in words."""
        files = {'vehicle': self.vehicle, 'gains': self.gains, 'strategy': self.strategy}
        told = [f'{name} {value}' for name, value in files.items() if value is not None]
        return told + [
            f'{node}.{name} = {value}'
            for node, given in self.settings.items()
            for name, value in given.items()
        ]


def parse_nodes(text: str) -> tuple[str, ...]:
    """Return the nodes of a list with commas; `BadInput` for one that cannot be run again."""
    names = tuple(dict.fromkeys(word.strip() for word in text.split(',') if word.strip()))
    known = list_answering_roles(load_topic_table())
    for name in names:
        if name not in known:
            raise unknown_name('node', name, known)
    if not names:
        raise BadInput(f'No node is named; give some of {", ".join(known)}.')
    return names


def read_recorded_settings(provenance: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """Return the nodes' parameters that were set for a flight in one process, by node."""
    found: dict[str, dict[str, Any]] = {}
    for text in filter(None, provenance.get('set', '').split('; ')):
        path, value = parse_assignment(text)
        root, _, below = path.partition('.')
        if root in OWNERS:
            node, prefix = OWNERS[root]
            quantity = parse_quantity(value)
            plain = value if quantity is None else Quantity.model_validate(quantity).si
            found.setdefault(node, {})[prefix + below] = plain
    return found


def check_request(order: ReplayRequest, flight: RecordedFlight) -> None:
    """Refuse what cannot be replayed from a recording, in one sentence."""
    if order.strategy is not None:
        find_strategy(order.strategy)
    table = load_topic_table()
    answers = order.node_selection.answers
    for node in order.nodes:
        trigger = table.trigger_topic(node)
        if trigger not in answers and trigger not in flight.topics:
            source = table[trigger].source
            remedy = (
                f'run {source} again as well, or ' if source in list_answering_roles(table) else ''
            )
            raise BadInput(
                f"'{order.bag}' has no '{trigger}', which {node} answers; {remedy}leave {node} "
                'out of --nodes.'
            )


def build_plan(order: ReplayRequest, flight: RecordedFlight, folder: Path) -> LaunchPlan:
    """
    Return the processes of a replay: the player and the nodes, as `fly.launch.yaml` has them.

    Parameters
    ----------
    order : Order
        What is asked for.
    flight : Flight
        The recording.
    folder : Path
        Where the results go; files that the recording carries are put there.

    """
    cast, table = order.node_selection, load_topic_table()
    player: dict[str, str | float] = {
        'nodes': ' '.join(cast.nodes),
        'roles': ' '.join(list_supporting_roles(table, cast.nodes)),
        'robot': flight.robot,
        'start': order.start,
        'end': order.end,
        'answers': str(folder / 'bag'),
    }
    changed: dict[str, Mapping[str, Any]] = {'player': player}
    for settings in (read_recorded_settings(flight.provenance), order.settings):
        changed |= {node: {**changed.get(node, {}), **own} for node, own in settings.items()}
    arguments = build_launch_arguments(order, flight, folder)
    plan = load_plan(find_file('launch file', 'fly', '.launch.yaml'), arguments)
    wanted = ('player', *cast.nodes)
    return LaunchPlan(
        tuple(
            add_parameters(process, changed.get(process.name, {}))
            for process in plan.processes
            if process.name in wanted
        )
    )


def build_launch_arguments(
    order: ReplayRequest, flight: RecordedFlight, folder: Path
) -> dict[str, str]:
    """Return a replay as arguments of `fly.launch.yaml`; files go to the folder."""
    told = flight.provenance
    return {
        'robot': flight.robot or ROBOT,
        'source': 'replay',
        'replay': str(order.bag),
        'time': 'lockstep' if order.rate is None else 'realtime',
        'rate': repr(float(order.rate or 1.0)),
        'record': 'false',
        'strategy': order.strategy or told.get('strategy', STRATEGY),
        **select_files(order, told, folder),
    }


def add_parameters(process: LaunchProcess, parameters: Mapping[str, Any]) -> LaunchProcess:
    """Return a process with more parameters; the last of a name counts."""
    words = [
        word
        for name, value in parameters.items()
        for word in ('-p', f'{name}:={format_ros_yaml(value)}')
    ]
    return replace(process, arguments=(*process.arguments, *words))


def select_files(
    order: ReplayRequest, provenance: Mapping[str, str], folder: Path
) -> dict[str, str]:
    """
    Return vehicle, gains and scenario: those that were asked for, else those that the bag carries.

    A scenario tells the course, where there is one.
    """
    vehicle = order.vehicle or extract_file(provenance, 'vehicle', folder) or VEHICLE
    control = load_vehicle(vehicle).file.control
    named = control.gains if control else None
    gains = str(find_file('gains', order.gains)) if order.gains else None
    if gains is None and order.vehicle is None:
        gains = extract_file(provenance, 'gains', folder)
    if gains is None and named:
        gains = str(find_file('gains', named))
    scenario = extract_file(provenance, 'scenario', folder) or LAMP_ROOM
    return {
        'vehicle': vehicle,
        'scenario': scenario,
        **({} if gains is None else {'gains': gains}),
    }


def extract_file(provenance: Mapping[str, str], name: str, folder: Path) -> str | None:
    """Return the path of a file that the recording carries, written to the folder."""
    text = provenance.get(f'{name}_file')
    if text is None:
        return None
    path = folder / f'{name}.yaml'
    try:
        path.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(f"'{path}' cannot be written ({error.strerror}); make room.") from error
    return str(path)
