# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The request of a replay: nodes, bag, and changed parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, final

from lta_bridge.parameters import FOREVER
from lta_bridge.playback.node_selection import (
    list_replayable_roles,
    list_supporting_roles,
    NodeSelection,
    select_nodes,
)
from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import find_file
from lta_config.topics import load_topic_table
from lta_control.strategies import find_navigation_strategy
from lta_data.bag.recorded_flight import RecordedFlight
from lta_data.scene import read_recorded_file
from lta_flight.recorded_choices import find_recorded_name, read_recorded_settings
from lta_graph.launch_plan import LaunchPlan
from lta_graph.launches import FLY
from lta_model.vehicle import load_vehicle
import yaml

UNNAMED_ROBOT = 'lta1'  # for a bag without namespaces
DEFAULT_VEHICLE, DEFAULT_STRATEGY, LAMP_ROOM = (
    'gtmab',
    'bag',
    'lamp_room',
)  # for a bag without provenance


@final
@dataclass(frozen=True, slots=True)
class ReplayRequest:
    """A requested replay."""

    bag: Path  # the recording
    nodes: tuple[str, ...]  # the nodes to run again
    # Changed parameters, by node and name
    settings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    # Replacements of the recording's own
    vehicle: str | None = None
    gains: str | None = None
    strategy: str | None = None
    rate: float | None = None  # bag seconds per wall second; None for lockstep
    # The section of the recording [s]
    start: float = 0.0
    end: float = FOREVER

    @property
    def node_selection(self) -> NodeSelection:
        """Return the nodes to run and the topics to play."""
        table = load_topic_table()
        return select_nodes(table, self.nodes, list_supporting_roles(table, self.nodes))

    @property
    def changes(self) -> list[str]:
        """Differences from the recording, in words."""
        files = {'vehicle': self.vehicle, 'gains': self.gains, 'strategy': self.strategy}
        replaced = [f'{name} {value}' for name, value in files.items() if value is not None]
        return replaced + [
            f'{node}.{name} = {value}'
            for node, settings in self.settings.items()
            for name, value in settings.items()
        ]


def parse_nodes(text: str) -> tuple[str, ...]:
    """Return the nodes of a comma-separated list; raise `BadInput` for an unknown one."""
    names = tuple(dict.fromkeys(word.strip() for word in text.split(',') if word.strip()))
    roles = list_replayable_roles(load_topic_table())
    for name in names:
        if name not in roles:
            raise unknown_name_error('node', name, roles)
    if not names:
        raise BadInput(
            f'No node to replay was given; name one or more with --nodes: {", ".join(roles)}.'
        )
    return names


def check_request(order: ReplayRequest, flight: RecordedFlight) -> None:
    """Reject a request that the recording cannot serve."""
    if order.strategy is not None:
        find_navigation_strategy(order.strategy)
    elif 'navigator' in order.nodes:
        find_recorded_name(flight.provenance, 'strategy')
    read_recorded_settings(flight.provenance, order.nodes)
    if order.vehicle is None:
        read_recorded_file(flight.provenance, 'vehicle_file')
    if 'navigator' in order.nodes and flight.provenance.get('commanded') == 'true':
        raise BadInput(
            f"'{order.bag}' is of a flight by actions, whose goals are not in the bag, so the "
            'navigator cannot be run again; leave navigator out of --nodes.'
        )
    table = load_topic_table()
    answers = order.node_selection.answers
    for node in order.nodes:
        trigger = table.trigger_topic(node)
        # The trigger must come from the recording or from a node that is run again
        if trigger not in answers and trigger not in flight.topics:
            source = table[trigger].source
            remedy = (
                f'add {source} to --nodes, or ' if source in list_replayable_roles(table) else ''
            )
            raise BadInput(
                f"'{order.bag}' has no topic '{trigger}', which the node {node} needs as input; "
                f'{remedy}leave {node} out of --nodes.'
            )


def build_launch_plan(order: ReplayRequest, flight: RecordedFlight, folder: Path) -> LaunchPlan:
    """
    Return the processes of a replay: player and nodes, as in the launch `fly`.

    `flight`: the recording. `folder`: results folder; files from the recording are extracted to
    it.
    """
    selection, table = order.node_selection, load_topic_table()
    player: dict[str, str | float] = {
        'nodes': ' '.join(selection.nodes),
        'roles': ' '.join(list_supporting_roles(table, selection.nodes)),
        'robot': flight.robot,
        'start': order.start,
        'end': order.end,
        'answers': str(folder / 'bag'),
    }
    changed: dict[str, Mapping[str, Any]] = {'player': player}
    # Requested settings last, since they override those of the recording
    recorded = read_recorded_settings(flight.provenance, order.nodes)
    for settings in (recorded, order.settings):
        changed |= {node: {**changed.get(node, {}), **own} for node, own in settings.items()}
    arguments = build_launch_arguments(order, flight, folder)
    plan = FLY.build_plan(arguments)
    roles = ('player', *selection.nodes)
    return LaunchPlan(
        tuple(
            replace(process, parameters={**process.parameters, **changed.get(process.name, {})})
            for process in plan.processes
            if process.name in roles
        )
    )


def build_launch_arguments(
    order: ReplayRequest, flight: RecordedFlight, folder: Path
) -> dict[str, str]:
    """Return a replay as arguments of the launch `fly`; extract files to the folder."""
    provenance = flight.provenance
    return {
        'robot': flight.robot or UNNAMED_ROBOT,
        'source': 'replay',
        'replay': str(order.bag),
        'time': 'lockstep' if order.rate is None else 'realtime',
        'rate': repr(float(order.rate or 1.0)),
        # The player records the answers itself
        'record': 'false',
        'strategy': select_strategy(order, provenance),
        'frame_prefix': find_frame_prefix(flight),
        **select_files(order, provenance, folder),
    }


def find_frame_prefix(flight: RecordedFlight) -> str:
    """Return the name of the robot as prefix, if the recorded frames have it."""
    table, prefix = load_topic_table(), f'{flight.robot}/'
    own = (
        f'/{prefix}{name}'
        for name in flight.topics
        if name in table.topics and table[name].stamped and table[name].frame not in ('', 'map')
    )
    first = next(flight.bag.iterate_messages(list(own)), None)
    if first is None:
        return ''
    name, _, data = first
    # A recording may have another type under this name
    header = getattr(flight.bag.decode(name, data), 'header', None)
    return prefix if getattr(header, 'frame_id', '').startswith(prefix) else ''


def select_files(
    order: ReplayRequest, provenance: Mapping[str, str], folder: Path
) -> dict[str, str]:
    """
    Return vehicle, gains and scenario: the requested ones, else those in the bag.

    The scenario is needed for its course, if it has one.
    """
    gains = str(find_file('gains', order.gains)) if order.gains else None
    # The recorded gains belong to the recorded vehicle
    if gains is None and order.vehicle is None:
        gains = extract_file(provenance, 'gains', folder)
    vehicle = (
        order.vehicle or extract_file(provenance, 'vehicle', folder, gains) or DEFAULT_VEHICLE
    )
    control = load_vehicle(vehicle).file.control
    named = control.gains if control else None
    if gains is None and named:
        gains = str(find_file('gains', named))
    scenario = extract_file(provenance, 'scenario', folder) or LAMP_ROOM
    return {
        'vehicle': vehicle,
        'scenario': scenario,
        **({} if gains is None else {'gains': gains}),
    }


def select_strategy(order: ReplayRequest, provenance: Mapping[str, str]) -> str:
    """Return the navigation strategy: the requested one, else the recorded one if it runs."""
    if order.strategy is None and 'navigator' in order.nodes:
        return find_recorded_name(provenance, 'strategy') or DEFAULT_STRATEGY
    return order.strategy or DEFAULT_STRATEGY


def extract_file(
    provenance: Mapping[str, str], name: str, folder: Path, gains: str | None = None
) -> str | None:
    """
    Write a file from the recording's provenance to the folder and return its path, if any.

    `gains`: the gains of a vehicle file that names none of LTA's own.
    """
    content = read_recorded_file(provenance, f'{name}_file')
    if content is None:
        return None
    if gains and isinstance(content, dict) and isinstance(content.get('control'), dict):
        content['control'].setdefault('gains', gains)
    path = folder / f'{name}.yaml'
    try:
        path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"'{path}' cannot be written ({error.strerror}); check that its folder is writable "
            'and has free space.'
        ) from error
    return str(path)
