"""
Name the energy balance in a DiagnosticArray like the fields of an EnergyStatus.

Older bags, and those of a machine without lta_msgs, have the numbers as texts with a key.
"""

from typing import Final

from lta_data.bag.merge import Columns

ARRAY: Final = 'diagnostic_msgs/msg/DiagnosticArray'
STATUSES: Final = {'status[0]': 'energy', 'status[1]': 'meters'}  # names, by path
FIELDS: Final = {
    'status[0].level': 'level',
    'status[0].message': 'message',
    'status[1].level': 'meters_level',
    'status[1].message': 'meters_message',
}


def rename_energy_columns(numbers: Columns, texts: Columns) -> tuple[Columns, Columns]:
    """Return the columns of an EnergyStatus; other arrays unchanged."""
    named = {f'{path}.name': name for path, name in STATUSES.items()}
    if not all(path in texts and (texts[path] == name).all() for path, name in named.items()):
        return numbers, texts
    renamed = {path: column for path, column in numbers.items() if path.startswith('header.')}
    renamed |= {name: numbers[path] for path, name in FIELDS.items() if path in numbers}
    words = {path: column for path, column in texts.items() if path.startswith('header.')}
    words |= {name: texts[path] for path, name in FIELDS.items() if path in texts}
    for path, keys in texts.items():
        if not path.endswith('.key'):
            continue
        values = texts[f'{path.removesuffix("key")}value']
        if (keys != keys[0]).any():
            return numbers, texts
        try:
            # A key is the name of the field and its unit
            renamed[str(keys[0]).rpartition('_')[0]] = values.astype(float)
        except ValueError:
            return numbers, texts
    return renamed, words
