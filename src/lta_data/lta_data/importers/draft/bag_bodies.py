"""Read poses and other topics of a bag, and choose the body that is the vehicle."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from lta_config.errors import unknown_name_error
from lta_config.schema.import_file import ImportMapping
from lta_data.importers.draft.bodies import STILL
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.entry_plan import SHAPES
from lta_data.importers.formats import FORMATS
from lta_data.importers.protocol import LogReader, LogTable
from lta_data.importers.readers.bag_tables import BagTableLog, BODIES, FURTHER
import numpy as np


def choose_body(
    path: Path, log: LogReader, types: Mapping[str, str], key: str, choices: DraftChoices
) -> dict[str, str]:
    """Return the table of the vehicle in a topic of several bodies, such as /tf, and its type."""
    assert isinstance(log, BagTableLog)
    tables = {
        name: kind
        for topic, kind in types.items()
        if kind in BODIES and not topic.endswith('_static')
        for name in log.list_bodies(topic)
    }
    if not tables:
        return {}
    chosen = choose_moving(path, tables, key, 'The bag has the poses of several bodies.', choices)
    return {chosen: tables[chosen]}


def choose_moving(
    path: Path, tables: Mapping[str, str], key: str, question: str, choices: DraftChoices
) -> str:
    """
    Return the table of poses of the only body that moves; of several, the user chooses.

    `tables`: message types by table.
    """
    extents = {}
    for name, table in read_tables(path, [*tables]).items():
        shape = FURTHER.get(tables[name]) or SHAPES[tables[name]]
        rows = np.stack([table.columns[f'{shape["position"].place}.{a}'] for a in 'xyz'], axis=1)
        low, high = np.nanpercentile(rows, [2.0, 98.0], axis=0)
        extents[name] = float(np.max(high - low))
    names = sorted(extents, key=lambda name: -extents[name])
    options = [(name, f'moves over {extents[name]:.3g}') for name in names]
    others = [name for name in names[1:] if extents[name] > STILL * extents[names[0]]]
    if others and key not in choices.answers:
        chosen = choices.decide(key, options, question)
    else:
        chosen = choices.override(key, names[0])
        listed = ', '.join(f'{name} ({words})' for name, words in options)
        choices.add_reason('body', [chosen], chosen, f'of {listed}')
    if chosen not in tables:
        raise unknown_name_error(f'answer to {key}', chosen, names)
    return chosen


def read_tables(path: Path, names: Sequence[str]) -> Mapping[str, LogTable]:
    """Return topics as tables, with a column for each number; those without a message lack."""
    if not names:
        return {}
    number = {'effort': {'column': '-'}}
    topics = [{'topic': 'motors', 'table': one, 'actuators': {'any': number}} for one in names]
    head = {'schema': 1, 'name': 'draft', 'about': 'A draft.', 'format': 'bag', 'data': 'measured'}
    log = FORMATS['bag'].opened(path, ImportMapping.model_validate({**head, 'topics': topics}))
    there = {name: set[str]() for name in names if name in log.columns}
    return log.read_tables(there)
