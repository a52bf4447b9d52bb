"""Draft the commands of a bag: arrays of numbers in topics that are named after actuators."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

from lta_config.schema.import_file import ImportMapping
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.draft.name_hints import ACTUATORS, COMMANDS, parse_column_name
from lta_data.importers.draft.scalar_draft import draft_scalars
from lta_data.importers.formats import FORMATS

ARRAY: Final = 'MultiArray'  # end of the types of arrays of numbers
DATA: Final = 'data['  # of them, what is a column


def draft_bag_commands(
    path: Path, types: Iterable[tuple[str, str]], choices: DraftChoices
) -> list[dict[str, Any]]:
    """
    Return the entry of the actuators of a bag; none if no topic is named after them.

    `types`: topics of the bag with their types. Several such topics are one entry each, of which
    an import uses the first.
    """
    entries = []
    for topic, kind in types:
        words = parse_column_name(topic).words
        if kind.endswith(ARRAY) and words & (ACTUATORS | COMMANDS):
            table = _read_numbers(path, topic)
            names = [
                # What the topic is called, its numbers are
                parse_column_name(column)._replace(stem=('motor', *words))
                for column in table
            ]
            entries += draft_scalars(topic, table, names, choices)
    return [entry for entry in entries if entry['topic'] == 'motors'][:1]


def _read_numbers(path: Path, topic: str) -> dict[str, Any]:
    """Return the columns of the array of a topic."""
    column = {'effort': {'column': f'{DATA}0]'}}
    reads = {'topic': 'motors', 'table': topic, 'actuators': {'motor': column}}
    head = {'schema': 1, 'name': 'draft', 'about': 'A draft.', 'format': 'bag', 'data': 'measured'}
    log = FORMATS['bag'].opened(path, ImportMapping.model_validate({**head, 'topics': [reads]}))
    tables = next(iter(log.iterate_tables({topic: set()}, lambda _: None)))
    return {name: one for name, one in tables[topic].columns.items() if name.startswith(DATA)}
