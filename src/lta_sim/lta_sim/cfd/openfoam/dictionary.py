"""Text of OpenFOAM's files: a header and nested entries."""

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
    """Return an entry that fits on one line."""
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
    """Return the lines of some entries; an empty key is a list or a word without a name."""
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
    Return a whole file.

    Parameters
    ----------
    name : str
        Of the file.
    entries : mapping
        What it holds; words go in as they are.
    kind : str
        Class of the object: 'dictionary', 'volScalarField' ...

    """
    return '\n'.join([HEADER.format(kind=kind, name=name), *format_entries(entries, ''), ''])
