"""Format OpenFOAM's dictionary files: a header and nested entries."""

from collections.abc import Mapping, Sequence
from typing import Final

Entry = str | bool | int | float | Sequence['Entry'] | Mapping[str, 'Entry']

HEADER: Final = """FoamFile
{{
    version     2.0;
    format      ascii;
    class       {kind};
    object      {name};
}}
"""


def format_entry(entry: Entry) -> str:
    """Format an entry on one line."""
    # Before int, because bool is a subclass of int
    if isinstance(entry, bool):
        return 'true' if entry else 'false'
    if isinstance(entry, str):
        return entry
    if isinstance(entry, int | float):
        return f'{entry:.10g}'
    if isinstance(entry, Mapping):
        return '{ ' + ' '.join(format_entries(entry, '')) + ' }'
    return f'({" ".join(format_entry(each) for each in entry)})'


def format_entries(entries: Mapping[str, Entry], indent: str) -> list[str]:
    """Format entries as lines; an empty key is a list or a word without a name."""
    text = []
    for key, entry in entries.items():
        if isinstance(entry, Mapping):
            text += [
                f'{indent}{key}',
                f'{indent}{{',
                *format_entries(entry, indent + '    '),
                f'{indent}}}',
            ]
        else:
            text.append(f'{indent}{key} {format_entry(entry)};')
    return text


def format_dictionary(name: str, entries: Mapping[str, Entry], kind: str = 'dictionary') -> str:
    """
    Format a whole file.

    `kind` is the class of the object: 'dictionary', 'volScalarField', ... Strings are written
    unquoted.
    """
    return '\n'.join([HEADER.format(kind=kind, name=name), *format_entries(entries, ''), ''])
