# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Generate the page of the `lta` verbs from their help texts.

It leaves to `lta VERB --help` what follows the first paragraph, examples as well, and prints the
options that many verbs share once.
"""

from collections import Counter
from collections.abc import Collection, Iterator
from typing import Any, Final

from lta_cli.app import build_app, FAMILIES
from typer.main import get_command

HEAD: Final = """# Verbs

Generated from the command line by `make reference`.

The verbs are grouped as in `lta --help`; `lta VERB --help` says more, with examples. Results go to
`runs/<time>-<name>/`. Exit status 0: done. 1: the run failed. 2: bad input, one sentence on
stderr. 130: Ctrl-C. Flights also end with 3: out of time, or 4: the drone left the room.

## Common options
Verbs that have them list their names under "Also". *Results* are `--out`, `--page`, `--no-page`,
`--pictures` and `--json`; *workers* are `--scheduler`, `--workers` and `--retry-failed`.

"""
SETS: Final = {
    '*workers*': ('`--scheduler`', '`--workers`', '`--retry-failed`'),
    '*results*': ('`--out`', '`--page`, `--no-page`', '`--pictures`', '`--json`'),
}
COMMON: Final = 5  # verbs that must have an option, with the same help, to print it once


def render_page() -> str:
    """Return the page: a section for each verb, by family, in the order of `lta --help`."""
    app = get_command(build_app())
    families = {
        family: [each for name in names for each in iterate_verbs(app, name)]
        for family, names in FAMILIES.items()
    }
    rows = Counter(
        row for verbs in families.values() for _, verb in verbs for row in iterate_rows(verb)
    )
    common = [row for row, count in rows.items() if count >= COMMON]
    sections = (
        f'\n## {family}\n' + ''.join(format_verb_section(*each, common) for each in verbs)
        for family, verbs in families.items()
    )
    return HEAD + ''.join(common) + ''.join(sections)


def iterate_verbs(parent: Any, name: str, title: str = '### lta') -> Iterator[tuple[str, Any]]:
    """Yield heading and command of a verb, then of its members, one level below."""
    command, title = parent.commands[name], f'{title} {name}'
    yield title, command
    if hasattr(command, 'commands'):
        for member in command.list_commands(None):
            yield from iterate_verbs(command, member, f'#{title}')


def iterate_rows(verb: Any) -> Iterator[str]:
    """Yield the item of each argument and option."""
    for param in verb.params:
        if not param.hidden and param.name != 'help':
            yield format_argument_row(param)


def format_verb_section(title: str, verb: Any, common: Collection[str]) -> str:
    """Return a verb's heading, help text and list of the arguments and options of its own."""
    text = f'\n{title}\n{format_docstring(verb.help or "")}'
    rows = list(iterate_rows(verb))
    if own := [row for row in rows if row not in common]:
        text += f'\n{"".join(own)}'
    if shared := [row.split(': ')[0].removeprefix('- ') for row in rows if row in common]:
        also = ', '.join(shared)
        for name, options in SETS.items():
            also = also.replace(', '.join(options), name)
        text += f'\nAlso: {also}.\n'
    return text


def format_docstring(text: str) -> str:
    """Format the first paragraph of a docstring as Markdown."""
    return escape_markdown(text.split('\n\n', maxsplit=1)[0]) + '\n'


def format_argument_row(param: Any) -> str:
    """Return one argument or option as an item of the list."""
    if param.opts[0].startswith('-'):
        names = ', '.join(f'`{name}`' for name in (*param.opts, *param.secondary_opts))
    else:
        names = f'`{param.metavar or param.name.upper()}`'
    default = '*Required.*' if param.required else format_option_default(param)
    return f'- {names}: {escape_markdown(param.help or "")} {default}'.rstrip() + '\n'


def format_option_default(param: Any) -> str:
    """Format the default of an option; empty if there is none."""
    if isinstance(param.show_default, str):
        return f'Default: {escape_markdown(param.show_default)}.'
    value = param.default
    # False is the default of every flag and not worth a word
    if not param.show_default or value is None or value is False or value in ('', (), []):
        return ''
    if value is True:
        return f'Default: `{param.opts[0]}`.'
    values = value if isinstance(value, list | tuple) else [value]
    return f'Default: {" ".join(f"`{item}`" for item in values)}.'


def escape_markdown(text: str) -> str:
    """Escape text for Markdown, on one line; quoted lta commands become code."""
    text = ' '.join(text.split()).replace('|', '\\|')
    parts = text.split('"')
    # An unpaired quotation mark: quote nothing
    if len(parts) % 2 == 0:
        return escape_markup(text)
    quoted = zip(parts, range(len(parts)), strict=True)
    return ''.join(
        f'`{part}`' if k % 2 and part.startswith('lta ') else escape_text_piece(part, k)
        for part, k in quoted
    )


def escape_text_piece(part: str, place: int) -> str:
    """Escape a piece of text and restore the quotation marks of quoted pieces."""
    return f'"{escape_markup(part)}"' if place % 2 else escape_markup(part)


def escape_markup(text: str) -> str:
    """Escape the characters that are special in Markdown or HTML."""
    # The characters that occur in help texts; others need no escape
    for mark in '<*_[':
        text = text.replace(mark, f'\\{mark}')
    return text
