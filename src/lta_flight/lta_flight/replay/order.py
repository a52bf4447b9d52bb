"""What to replay: which nodes, on which bag, with which of their parameters changed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, final

from lta_bridge.playback.cast import Cast, cast_of, roles, supporting
from lta_bridge.playback.settings import FOREVER
from lta_config.errors import BadInput, unknown
from lta_config.files import find
from lta_config.override import assignment, quantity_in
from lta_config.quantity import Quantity
from lta_config.topics import topic_table
from lta_control.strategies import strategy
from lta_data.bag.flight import Flight
from lta_graph.launch_file import LaunchPlan, load
from lta_graph.launch_node import Process, ros_yaml
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
class Order:
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
    def cast(self) -> Cast:
        """Who is run, and what is played."""
        table = topic_table()
        return cast_of(table, self.nodes, supporting(table, self.nodes))

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


def nodes_of(text: str) -> tuple[str, ...]:
    """Return the nodes of a list with commas; `BadInput` for one that cannot be run again."""
    names = tuple(dict.fromkeys(word.strip() for word in text.split(',') if word.strip()))
    known = roles(topic_table())
    for name in names:
        if name not in known:
            raise unknown('node', name, known)
    if not names:
        raise BadInput(f'No node is named; give some of {", ".join(known)}.')
    return names


def recorded_settings(told: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """Return the nodes' parameters that were set for a flight in one process, by node."""
    found: dict[str, dict[str, Any]] = {}
    for text in filter(None, told.get('set', '').split('; ')):
        path, value = assignment(text)
        root, _, below = path.partition('.')
        if root in OWNERS:
            node, prefix = OWNERS[root]
            quantity = quantity_in(value)
            plain = value if quantity is None else Quantity.model_validate(quantity).si
            found.setdefault(node, {})[prefix + below] = plain
    return found


def check(order: Order, flight: Flight) -> None:
    """Refuse what cannot be replayed from a recording, in one sentence."""
    if order.strategy is not None:
        strategy(order.strategy)
    table = topic_table()
    answers = order.cast.answers
    for node in order.nodes:
        trigger = table.trigger(node)
        if trigger not in answers and trigger not in flight.topics:
            source = table[trigger].source
            remedy = f'run {source} again as well, or ' if source in roles(table) else ''
            raise BadInput(
                f"'{order.bag}' has no '{trigger}', which {node} answers; {remedy}leave {node} "
                'out of --nodes.'
            )


def plan_of(order: Order, flight: Flight, folder: Path) -> LaunchPlan:
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
    cast, table = order.cast, topic_table()
    player: dict[str, str | float] = {
        'nodes': ' '.join(cast.nodes),
        'roles': ' '.join(supporting(table, cast.nodes)),
        'robot': flight.robot,
        'start': order.start,
        'end': order.end,
        'answers': str(folder / 'bag'),
    }
    changed: dict[str, Mapping[str, Any]] = {'player': player}
    for settings in (recorded_settings(flight.provenance), order.settings):
        changed |= {node: {**changed.get(node, {}), **own} for node, own in settings.items()}
    arguments = launch_arguments(order, flight, folder)
    plan = load(find('launch file', 'fly', '.launch.yaml'), arguments)
    wanted = ('player', *cast.nodes)
    return LaunchPlan(
        tuple(
            with_parameters(process, changed.get(process.name, {}))
            for process in plan.processes
            if process.name in wanted
        )
    )


def launch_arguments(order: Order, flight: Flight, folder: Path) -> dict[str, str]:
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
        **files_of(order, told, folder),
    }


def with_parameters(process: Process, given: Mapping[str, Any]) -> Process:
    """Return a process with more parameters; the last of a name counts."""
    words = [
        word for name, value in given.items() for word in ('-p', f'{name}:={ros_yaml(value)}')
    ]
    return replace(process, arguments=(*process.arguments, *words))


def files_of(order: Order, told: Mapping[str, str], folder: Path) -> dict[str, str]:
    """
    Return vehicle, gains and scenario: those that were asked for, else those that the bag carries.

    A scenario tells the course, where there is one.
    """
    vehicle = order.vehicle or kept(told, 'vehicle', folder) or VEHICLE
    control = load_vehicle(vehicle).file.control
    named = control.gains if control else None
    gains = str(find('gains', order.gains)) if order.gains else None
    if gains is None and order.vehicle is None:
        gains = kept(told, 'gains', folder)
    if gains is None and named:
        gains = str(find('gains', named))
    scenario = kept(told, 'scenario', folder) or LAMP_ROOM
    return {
        'vehicle': vehicle,
        'scenario': scenario,
        **({} if gains is None else {'gains': gains}),
    }


def kept(told: Mapping[str, str], name: str, folder: Path) -> str | None:
    """Return the path of a file that the recording carries, written to the folder."""
    text = told.get(f'{name}_file')
    if text is None:
        return None
    path = folder / f'{name}.yaml'
    try:
        path.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(f"'{path}' cannot be written ({error.strerror}); make room.") from error
    return str(path)
