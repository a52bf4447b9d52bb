"""The verbs of the `lta` command as a page, from what `--help` tells."""

from collections.abc import Iterator
from typing import Any

from lta_cli.app import put_together
from typer.main import get_command

HEAD = """# Verbs

Generated from the command line by `python -m lta_cli.reference verbs > docs/verbs.md`.

`lta VERB --help` tells the same at the terminal. Results go to `runs/<time>-<name>/`. Exit status
0: done. 1: the run failed. 2: bad input, one sentence on stderr.
"""


def page() -> str:
    """Return the page: a section for each verb, in the order of `lta --help`."""
    sections = (section(words, verb) for words, verb in verbs(get_command(put_together())))
    return HEAD + ''.join(sections)


def verbs(command: Any, words: str = 'lta') -> Iterator[tuple[str, Any]]:  # noqa: ANN401 - Typer's
    """Yield every verb with the words that call it, those behind a word after it."""
    if words != 'lta':
        yield words, command
    if hasattr(command, 'commands'):
        for name in command.list_commands(None):
            yield from verbs(command.commands[name], f'{words} {name}')


def section(words: str, verb: Any) -> str:  # noqa: ANN401 - a command of Typer
    """Return a verb's heading, manual and table of what it takes."""
    deep = '#' * words.count(' ')
    text = f'\n#{deep} {words}\n{manual(verb.help or "")}'
    rows = [row(param) for param in verb.params if not param.hidden and param.name != 'help']
    if rows:
        text += '\n| takes | what | unless told |\n|---|---|---|\n' + ''.join(rows)
    return text


def manual(text: str) -> str:
    """Return a docstring's paragraphs, examples as code."""
    paragraphs = [' '.join(part.split()) for part in text.split('\n\n')]
    lines = [plain(p) if not p.startswith('Example') else example(p) for p in paragraphs if p]
    return '\n\n'.join(lines) + '\n'


def example(paragraph: str) -> str:
    """Return the paragraph of an example with its command as code."""
    word, _, command = paragraph.partition(': ')
    return f'{word}: `{command}`'


def row(param: Any) -> str:  # noqa: ANN401 - a parameter of Typer
    """Return one argument or option as a row of the table."""
    if param.opts[0].startswith('-'):
        names = ', '.join(f'`{name}`' for name in (*param.opts, *param.secondary_opts))
    else:
        names = f'`{param.metavar or param.name.upper()}`'
    needed = '*needed*' if param.required else default(param)
    return f'| {names} | {plain(param.help or "")} | {needed} |\n'


def default(param: Any) -> str:  # noqa: ANN401 - a parameter of Typer
    """Return what counts where an option is not given, empty where that is nothing."""
    if isinstance(param.show_default, str):
        return plain(param.show_default)
    value = param.default
    if not param.show_default or value is None or value is False or value in ('', (), []):
        return ''
    if value is True:
        return f'`{param.opts[0]}`'
    values = value if isinstance(value, list | tuple) else [value]
    return ' '.join(f'`{item}`' for item in values)


def plain(text: str) -> str:
    """Return text in which nothing is taken for markup, on one line; quoted commands as code."""
    text = ' '.join(text.split()).replace('|', '\\|')
    parts = text.split('"')
    if len(parts) % 2 == 0:
        return escaped(text)
    quoted = zip(parts, range(len(parts)), strict=True)
    return ''.join(
        f'`{part}`' if k % 2 and part.startswith('lta ') else quote(part, k) for part, k in quoted
    )


def quote(part: str, place: int) -> str:
    """Return a piece of text between quotation marks, with them where it stood within."""
    return f'"{escaped(part)}"' if place % 2 else escaped(part)


def escaped(text: str) -> str:
    """Return text with the characters that Markdown or HTML would take."""
    for mark in '<*_[':
        text = text.replace(mark, f'\\{mark}')
    return text
