"""Generate the page of the `lta` verbs from their help texts."""

from collections.abc import Iterator
from typing import Any

from lta_cli.app import build_app
from typer.main import get_command

HEAD = """# Verbs

Generated from the command line by `python -m lta_cli.reference verbs > docs/verbs.md`.

`lta VERB --help` shows the same in the terminal. Results go to `runs/<time>-<name>/`. Exit status
0: done. 1: the run failed. 2: bad input, one sentence on stderr. Flights
also end with 3: out of time, or 4: the drone left the room.
"""


def render_page() -> str:
    """Return the page: a section for each verb, in the order of `lta --help`."""
    sections = (
        format_verb_section(words, verb) for words, verb in iterate_verbs(get_command(build_app()))
    )
    return HEAD + ''.join(sections)


def iterate_verbs(command: Any, words: str = 'lta') -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - Typer's
    """Yield the full name and the command of every verb, each group before its members."""
    # The root command has no section
    if words != 'lta':
        yield words, command
    if hasattr(command, 'commands'):
        for name in command.list_commands(None):
            yield from iterate_verbs(command.commands[name], f'{words} {name}')


def format_verb_section(words: str, verb: Any) -> str:  # noqa: ANN401 - a command of Typer
    """Return a verb's heading, help text and table of arguments and options."""
    # A group is a level-2 heading, its verbs are level 3
    deep = '#' * words.count(' ')
    text = f'\n#{deep} {words}\n{format_docstring(verb.help or "")}'
    rows = [
        format_argument_row(param)
        for param in verb.params
        if not param.hidden and param.name != 'help'
    ]
    if rows:
        text += '\n| argument or option | meaning | default |\n|---|---|---|\n' + ''.join(rows)
    return text


def format_docstring(text: str) -> str:
    """Format a docstring as Markdown, with examples as code."""
    paragraphs = [' '.join(part.split()) for part in text.split('\n\n')]
    lines = [
        escape_markdown(p) if not p.startswith('Example') else format_example(p)
        for p in paragraphs
        if p
    ]
    return '\n\n'.join(lines) + '\n'


def format_example(paragraph: str) -> str:
    """Format an example with its command as code."""
    word, _, command = paragraph.partition(': ')
    return f'{word}: `{command}`'


def format_argument_row(param: Any) -> str:  # noqa: ANN401 - a parameter of Typer
    """Return one argument or option as a row of the table."""
    if param.opts[0].startswith('-'):
        names = ', '.join(f'`{name}`' for name in (*param.opts, *param.secondary_opts))
    else:
        names = f'`{param.metavar or param.name.upper()}`'
    default = '*required*' if param.required else format_option_default(param)
    return f'| {names} | {escape_markdown(param.help or "")} | {default} |\n'


def format_option_default(param: Any) -> str:  # noqa: ANN401 - a parameter of Typer
    """Format the default of an option; empty if there is none."""
    if isinstance(param.show_default, str):
        return escape_markdown(param.show_default)
    value = param.default
    # False is the default of every flag and not worth a column entry
    if not param.show_default or value is None or value is False or value in ('', (), []):
        return ''
    if value is True:
        return f'`{param.opts[0]}`'
    values = value if isinstance(value, list | tuple) else [value]
    return ' '.join(f'`{item}`' for item in values)


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
