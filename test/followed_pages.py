# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Follow a page from its top to its end in a copy of the working tree, as a reader would.

Blocks of shell are typed line by line, blocks of Python run by `./lta run`. Further:

    ```python title="PATH"                 is written to a new file
    ```python title="PATH, below LINE"     is put into a file below (above) its line that begins so
    > text                                 is output of a command above it; a number may differ
                                           by one in its last digit, as on another processor
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
import math
import os
from pathlib import Path
import re
import shutil
import subprocess

from doc_blocks import blocks, ROOT, run

# What the copy inherits: the workspace of the tests would bring the code of the original
INHERITED = {'HOME', 'LANG', 'OPENBLAS_CORETYPE', 'ROS_DOMAIN_ID', 'TMPDIR', 'XDG_RUNTIME_DIR'}
WRITTEN = re.compile(
    r'^```\w+ title="([\w/.]+)(?:, (above|below) ([^"]+))?"\n(.*?)^```', re.MULTILINE | re.DOTALL
)
QUOTED = re.compile(r'^> (.*)$', re.MULTILINE)
NUMBER = re.compile(r'\d+(?:\.\d+)?')


@dataclass(frozen=True)
class Typed:
    """Lines of shell, or a program in Python."""

    language: str
    text: str

    def do(self, tree: 'Tree') -> None:
        """Run it; what it said is kept."""
        if self.language == 'python':
            program = tree.beside / 'block.py'
            program.write_text(self.text, encoding='utf-8')
            tree.run(f'./lta run {program}')
        else:
            tree.run(self.text)


@dataclass(frozen=True)
class Written:
    """A file that the reader creates, or lines that he puts into one."""

    path: str
    where: str
    line: str
    text: str

    def do(self, tree: 'Tree') -> None:
        """Write it."""
        place = tree.folder / self.path
        if not self.where:
            assert not place.exists(), f'{self.path} is there already'
            place.write_text(self.text, encoding='utf-8')
            return
        lines = place.read_text(encoding='utf-8').splitlines(keepends=True)
        (k,) = (k for k, line in enumerate(lines) if line.strip().startswith(self.line))
        lines.insert(k + (self.where == 'below'), self.text)
        place.write_text(''.join(lines), encoding='utf-8')


@dataclass(frozen=True)
class Quoted:
    """What the page shows of the output."""

    text: str

    def do(self, tree: 'Tree') -> None:
        """Find it in what has been said."""
        assert is_said(self.text, tree.said), f'{self.text}\nis not in\n{tree.said[-8000:]}'


def is_said(shown: str, said: str) -> bool:
    """Return whether a text stands in another, but for the last digit of its numbers."""
    words = [re.escape(word) for word in NUMBER.sub('0', shown).split()]
    pattern = r'\s+'.join(words).replace('0', rf'({NUMBER.pattern})')
    numbers = NUMBER.findall(shown)
    return any(
        all(math.isclose(float(a), float(b), abs_tol=1.01 * last_digit(a))
            for a, b in zip(numbers, match.groups(), strict=True))
        for match in re.finditer(pattern, said)
    )  # fmt: skip


def last_digit(number: str) -> float:
    """Return the value of a one in the last place of a number."""
    return float(10 ** -len(number.partition('.')[2]))


def steps(page: str) -> list[Typed | Written | Quoted]:
    """Return what a reader of a page does, from its top to its end."""
    text = (ROOT / page).read_text(encoding='utf-8')
    found: list[tuple[int, Typed | Written | Quoted]] = [
        (block.line, Typed(language, command))
        for block in blocks()
        if block.page == page
        for language, command, _ in block.runs
    ]
    for kind, pattern in ((Written, WRITTEN), (Quoted, QUOTED)):
        found += [
            (text[: match.start()].count('\n') + 1, kind(*(each or '' for each in match.groups())))
            for match in pattern.finditer(text)
        ]
    return [step for _, step in sorted(found, key=lambda each: each[0])]


@dataclass
class Tree:
    """A copy of the working tree, built, with the environment of the original."""

    folder: Path
    beside: Path
    said: str = field(default='', init=False)

    def run(self, line: str, seconds: float = 3600.0) -> str:
        """Type a line; what it says is returned, and kept for the quotes of the page."""
        path = os.pathsep.join([str(self.beside / 'bin'), os.environ['PATH']])
        inherited = {key: os.environ[key] for key in INHERITED & os.environ.keys()}
        said = run('sh', line, self.folder, seconds, env=inherited | {'PATH': path})
        self.said += said
        return said

    def reset(self) -> None:
        """Undo what a page did; what was compiled stays."""
        self.run('git checkout -q . && git clean -fdq && rm -rf runs my_*')
        self.said = ''

    def untracked(self) -> list[str]:
        """Return the files that are new and not ignored."""
        return self.run('git ls-files --others --exclude-standard').splitlines()


def copy_tree(folder: Path) -> Tree:
    """Copy the working tree into a folder, without what git ignores, and build it."""
    tree = Tree(folder / 'lta', folder)
    for name in tracked():
        place = tree.folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, place)
    (tree.folder / '.venv').symlink_to(ROOT / '.venv')
    # The environment is that of the original: nothing is fetched
    make = folder / 'bin/make'
    make.parent.mkdir()
    make.write_text(f'#!/bin/sh\nexec {shutil.which("make")} -o test-environment -o build "$@"\n')
    make.chmod(0o755)
    tree.run(
        'git init -q && git add -A && git -c user.name=a -c user.email=a '
        '-c commit.gpgsign=false commit -q -m copy && tools/build.sh'
    )
    return tree


def tracked() -> Iterator[str]:
    """Yield the files of the working tree that git does not ignore."""
    words = ['git', '-C', str(ROOT), 'ls-files', '-co', '--exclude-standard', '-z']
    names = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    yield from (name for name in names.split('\0') if name and (ROOT / name).is_file())
