# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write `locked/*.txt`: every package of the environments with its version and its files' hashes.

`make lock` after a change of requirements*.txt or constraints.txt. What is needed is read from the
packages that .venv (and .venv-docs) has, for each Python that LTA runs on; versions are those that
are pinned; hashes are those that the package index tells now, of the files that pip may take on
Linux on x86-64. pip then takes nothing else (`--require-hashes`), whatever a mirror offers.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from html.parser import HTMLParser
from importlib import metadata
from pathlib import Path
import re
import sys
from typing import Final, NamedTuple
from urllib.parse import unquote, urldefrag, urljoin
from urllib.request import urlopen

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name, InvalidWheelFilename, parse_wheel_filename

ROOT: Final = Path(__file__).resolve().parents[1]
INDEX: Final = 'https://pypi.org/simple/'
PYTHONS: Final = ('3.11', '3.12', '3.13', '3.14')


class Lock(NamedTuple):
    """What a locked file is made of: what is asked for, what came before it, and where it is."""

    source: str
    before: tuple[str, ...] = ()
    environment: str = '.venv'


LOCKS: Final = {
    'uv': Lock('uv'),
    'compiler': Lock('ziglang'),
    'build': Lock('setuptools'),
    'run': Lock('requirements.txt', ('build',)),
    'test': Lock('requirements-test.txt', ('build', 'run')),
    'docs': Lock('requirements-docs.txt', environment='.venv-docs'),
}
HEAD: Final = '# `make lock` wrote this from requirements*.txt and constraints.txt.\n'


def asked(source: str) -> list[Requirement]:
    """Return what a requirements file asks for, or the one package of that name."""
    path = ROOT / source
    lines = path.read_text(encoding='utf-8').splitlines() if path.suffix else [source]
    return [Requirement(line) for line in lines if line and not line.startswith('#')]


def pins(*sources: str) -> dict[str, str]:
    """Return the versions that are pinned, by normalised name."""
    each = (one for source in sources for one in asked(source))
    return {
        canonicalize_name(one.name): version.removeprefix('==')
        for one in each
        if (version := str(one.specifier)).startswith('==')
    }


@cache
def installed(environment: str) -> dict[str, list[Requirement]]:
    """Return what each package of an environment requires, by normalised name."""
    folders = [str(path) for path in (ROOT / environment).glob('lib/python*/site-packages')]
    return {
        canonicalize_name(one.name): [Requirement(line) for line in one.requires or ()]
        for one in metadata.distributions(path=folders)
    }


def closure(lock: Lock, python: str) -> set[str]:
    """Return the normalised names of all that a Python needs for what is asked for."""
    if not lock.source.endswith('.txt'):
        return {lock.source}  # one package, which needs no other, and may not be installed
    has = installed(lock.environment)
    world = {'python_version': python, 'python_full_version': f'{python}.0'}
    waiting, seen = asked(lock.source), set[tuple[str, str]]()
    while waiting:
        one = waiting.pop()
        name = canonicalize_name(one.name)
        if name not in has:
            sys.exit(
                f'{name} is not in {lock.environment}; put it there ({lock.environment}/bin/pip '
                f'install -c constraints.txt -r {lock.source}) and run make lock again.'
            )
        for extra in {'', *one.extras} - {extra for known, extra in seen if known == name}:
            seen.add((name, extra))
            for further in has[name]:
                if not further.marker or further.marker.evaluate({**world, 'extra': extra}):
                    waiting.append(further)
    return {name for name, _ in seen}


def needed(lock: Lock, pythons: Sequence[str]) -> dict[str, str]:
    """Return what some Pythons need for what is asked for: names, with markers ('': all)."""
    by_python = {python: closure(lock, python) for python in pythons}
    return {
        name: marker([python for python, names in by_python.items() if name in names], pythons)
        for name in sorted(set().union(*by_python.values()))
    }


def marker(some: Sequence[str], pythons: Sequence[str]) -> str:
    """Return the marker of some neighbouring Pythons among others, '' for all."""
    bounds = (f"python_version >= '{some[0]}'", f"python_version <= '{some[-1]}'")
    inner = (some[0] != pythons[0], some[-1] != pythons[-1])
    return ' and '.join(bound for bound, is_one in zip(bounds, inner, strict=True) if is_one)


class Links(HTMLParser):
    """The files of one project on the simple index: name and SHA-256 of each."""

    def __init__(self) -> None:
        super().__init__()
        self.files: dict[str, str] = {}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take a link."""
        address, fragment = urldefrag(dict(attrs).get('href') or '')
        if tag == 'a' and fragment.startswith('sha256='):
            self.files[unquote(address.rsplit('/', 1)[-1])] = fragment.removeprefix('sha256=')


@cache
def files(name: str) -> dict[str, str]:
    """Return the hashes of all files of a project, by file name."""
    page = Links()
    with urlopen(urljoin(INDEX, f'{name}/'), timeout=60) as answer:
        page.feed(answer.read().decode())
    return page.files


def hashes(name: str, version: str) -> list[str]:
    """Return the hashes of the files that pip may take: wheels that fit, or else the source."""
    wheels, sources = [], []
    for file, found in files(name).items():
        if file.endswith('.whl') and fits(file, version):
            wheels.append(found)
        elif re.fullmatch(rf'.+-{re.escape(version)}\.(tar\.gz|zip)', file):
            sources.append(found)
    if not (chosen := wheels or sources):
        sys.exit(f'{INDEX} has no file of {name} {version}; correct its pin.')
    return sorted(chosen)


def fits(file: str, version: str) -> bool:
    """Tell whether a wheel is one of a version for our Pythons on Linux on x86-64."""
    try:
        _, found, _, tags = parse_wheel_filename(file)
    except InvalidWheelFilename:
        return False
    ours = {f'cp{python.replace(".", "")}' for python in PYTHONS}
    return str(found) == version and any(
        (tag.platform == 'any' or (tag.platform.endswith('_x86_64') and 'linux' in tag.platform))
        and 'musl' not in tag.platform
        and (tag.interpreter in ours or tag.interpreter.startswith('py3') or tag.abi == 'abi3')
        for tag in tags
    )


def lines(names: Mapping[str, str], versions: Mapping[str, str]) -> Iterator[str]:
    """Yield the locked lines of some packages."""
    with ThreadPoolExecutor(8) as pool:
        each = pool.map(lambda name: hashes(name, versions[name]), names)
        for (name, where), found in zip(names.items(), each, strict=True):
            wanted = f'{name}=={versions[name]}' + (f' ; {where}' if where else '')
            yield ' \\\n    '.join([wanted, *(f'--hash=sha256:{one}' for one in found)]) + '\n'


def locked(names: Iterable[str], pythons: Sequence[str] = PYTHONS) -> dict[str, dict[str, str]]:
    """
    Return what some locked files hold, in their order: packages with their markers.

    An environment of the newest Python lacks what older ones alone need, and can tell no more
    than what it needs itself.
    """
    found: dict[str, dict[str, str]] = {}
    for name in names:
        lock = LOCKS[name]
        earlier = {one for before in lock.before for one in found[before]}
        found[name] = {
            one: where for one, where in needed(lock, pythons).items() if one not in earlier
        }
    return found


def main() -> None:
    """Write the files."""
    for name, packages in locked(LOCKS).items():
        versions = pins('constraints.txt', LOCKS[name].source)
        text = HEAD + ''.join(lines(packages, versions))
        (ROOT / f'locked/{name}.txt').write_text(text, encoding='utf-8')


if __name__ == '__main__':
    main()
