# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The commands and Python blocks of the pages for people, and how each is tested.

Every line of a ```sh block and every ```python block is run, in `make test-long`: README and the
tutorials from their top to their end (`followed_pages.py`), of other pages each for itself. A
comment above the block, seen in the source alone, says otherwise:

    <!-- quick -->                    it takes a second or two: `make test` runs it
    <!-- quick, TEXT -->              lines that hold TEXT do
    <!-- not run: why -->             nothing of it is run
    <!-- not run, TEXT: why -->       lines that hold TEXT are not run

What is not run is still parsed: its verb, options, launch arguments and make target exist.
"""

from dataclasses import dataclass
from pathlib import Path
import re
import shlex
import subprocess
import sys

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted(ROOT.glob('docs/**/*.md'))]
FOLLOWED = [str(path.relative_to(ROOT)) for path in PAGES
            if path.name == 'README.md' or path.parent.name == 'tutorials']  # fmt: skip
BLOCK = re.compile(
    r'((?:^<!-- (?:quick|not run)[^\n]*-->\n)*)^```(sh|python)\n(.*?)^```', re.M | re.S
)
MARK = re.compile(r'^<!-- (quick|not run)(?:, ([^:\n]*?))?(?:: (.*))? -->$', re.MULTILINE)
CODE = re.compile(r'`((?:\./)?lta [a-z][^`]*|make [a-z][^`]*)`')
SPAN = re.compile(r'`([^`]*:=[^`]*)`')
SETTING = re.compile(r'(-p )?\b([a-z0-9_.]+):=')
FENCED = re.compile(r'^```.*?^```', re.MULTILINE | re.DOTALL)
APART = {'&&', '||', ';', '|', '(', ')', '&'}
HIDDEN = {'docs/verbs.md', 'docs/parameters.md'}  # made of the declarations that would check them


@dataclass(frozen=True)
class Block:
    """A fenced block: its page and line, its language, its text, and what is said above it."""

    page: str
    line: int
    language: str
    text: str
    marks: tuple[tuple[str, str, str], ...]

    def __str__(self):
        return f'{self.page}:{self.line}'

    @property
    def lines(self):
        """The command lines, those that go on joined."""
        joined = self.text.replace('\\\n', ' ')
        return [line for line in joined.splitlines() if shlex.split(line, comments=True)]

    def is_marked(self, kind, text):
        """Return whether a line, or the whole of a Python block, is marked so."""
        return any(marked == kind and part in text for marked, part, _ in self.marks)

    @property
    def runs(self):
        """What is run of it: (language, text, whether it is quick) each."""
        texts = self.lines if self.language == 'sh' else [self.text]
        return [
            (self.language, text, self.is_marked('quick', text))
            for text in texts
            if not self.is_marked('not run', text)
        ]


def blocks():
    """Return every block of every page."""
    found = []
    for path in PAGES:
        page = path.read_text(encoding='utf-8')
        for match in BLOCK.finditer(page):
            line = page[: match.start(2)].count('\n') + 1
            name = str(path.relative_to(ROOT))
            marks = tuple(MARK.findall(match[1]))
            found.append(Block(name, line, match[2], match[3], marks))
    return found


def pieces(quick):
    """
    Return what is run in a folder of its own, by its name: (language, text) one after the other.

    With `quick` only what is so, of followed pages one after the other; else what is not and does
    not stand on a followed page.
    """
    found = {}
    for block in blocks():
        follows = block.page in FOLLOWED
        for k, (language, text, is_quick) in enumerate(block.runs):
            if is_quick == quick and (quick or not follows):
                name = block.page if follows else f'{block}.{k}'
                found.setdefault(name, []).append((language, text))
    return found


def spoken():
    """Return the commands that stand in running text, by page, those with words left out but."""
    return sorted(
        {
            (str(path.relative_to(ROOT)), code)
            for path in PAGES
            for code in CODE.findall(path.read_text(encoding='utf-8'))
            if str(path.relative_to(ROOT)) not in HIDDEN
        }
    )


def settings_spoken():
    """Return settings that stand alone in running text: page, whether of a node (-p), name."""
    return sorted(
        {
            (str(path.relative_to(ROOT)), bool(of_node), name)
            for path in PAGES
            for span in SPAN.findall(FENCED.sub('', path.read_text(encoding='utf-8')))
            for of_node, name in SETTING.findall(span)
            if str(path.relative_to(ROOT)) not in HIDDEN
        }
    )


def simple(line):
    """Return the commands of a shell line, each as its words, without where they write to."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    commands, words = [], []
    for token in lexer:
        if token in APART:
            commands.append(words)
            words = []
        else:
            words.append(token)
    commands.append(words)
    kept = []
    for command in filter(None, commands):
        cut = next((k for k, word in enumerate(command) if word in {'>', '>>', '<'}), None)
        kept.append(command[:cut])
    return kept


def stage(folder):
    """Link what commands of the pages name into a folder to run them in; nothing is written to."""
    for name in ('lta', '.venv', 'config', 'docs', 'examples', 'src', 'test', 'tools'):
        (folder / name).symlink_to(ROOT / name)


def run(language, text, folder, seconds, env=None):
    """Run a line of shell or a block of Python in a folder, and return what it said."""
    program = ['bash', '-ec'] if language == 'sh' else [sys.executable, '-c']
    done = subprocess.run(
        [*program, text],
        cwd=folder,
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=seconds,
    )
    assert done.returncode == 0, f'{text}\n{done.stdout[-2000:]}'
    return done.stdout
