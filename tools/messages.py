"""
Generate and compile message packages that no wheel has, and install them into .venv.

    .venv/bin/python tools/messages.py FOLDER ...

Each folder has a package.xml and msg/*.msg. The generators are those of ROS 2, which come with its
wheels; they write C and C++, so a compiler and the headers of Python are needed. Exit status 3:
one of them is missing; 1: it failed. Then nothing was changed.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
import fcntl
from importlib import metadata
import io
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
import sysconfig
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np

VENV = Path(sys.prefix)
SITE = Path(sysconfig.get_path('purelib'))
TYPESUPPORTS = ('rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_introspection_c')
UNAVAILABLE = 3  # exit status


def use_each_entry_point_once() -> None:
    """Hide repeated entry points: the ROS wheels declare theirs twice, which rosidl refuses."""

    def list_entry_points(**wanted: str) -> metadata.EntryPoints:
        points = {
            (each.group, each.name): each
            for distribution in metadata.distributions()
            for each in distribution.entry_points
        }
        return metadata.EntryPoints(points.values()).select(**wanted)

    metadata.entry_points = list_entry_points  # type: ignore[assignment]


def find_missing() -> str:
    """Return what the machine lacks to compile, in words; '' if nothing."""
    words = [f'the compiler {name}' for name in ('cc', 'c++') if shutil.which(name) is None]
    if not Path(sysconfig.get_path('include'), 'Python.h').is_file():
        words.append('the headers of Python')
    return ' and '.join(words)


class MessagePackage:
    """
    A package of messages, its generated sources and its libraries.

    Parameters
    ----------
    folder : Path
        Folder with package.xml and msg/*.msg.
    work : Path
        Empty folder for sources and libraries.

    """

    def __init__(self, folder: Path, work: Path) -> None:
        self.folder, self.work = folder, work
        self.name = ElementTree.parse(folder / 'package.xml').findtext('name')
        self.messages = sorted(folder.glob('msg/*.msg'))
        self.source, self.built = work / 'source', work / 'built'
        self.uses = sorted(
            {
                package
                for path in self.messages
                for package in re.findall(r'^(\w+)/\w', path.read_text('utf-8'), re.MULTILINE)
            }
        )

    def generate(self) -> None:
        """Write the sources in C, C++ and Python."""
        from rosidl_cli.command.generate.api import generate

        os.chdir(self.folder)
        # The generators print each file that they read
        with redirect_stdout(io.StringIO()):
            generate(
                package_name=self.name,
                interface_files=[f'msg/{path.name}' for path in self.messages],
                include_paths=[str(VENV / 'share')],
                output_path=self.source,
                types=['py', 'c'],
                typesupports=['c', 'fastrtps_c', 'introspection_c'],
            )

    def compile(self) -> None:
        """Compile all libraries."""
        include = self.built / 'include' / self.name
        for kind in ('c', 'fastrtps_c', 'introspection_c'):
            for header in (self.source / kind).rglob('*.h'):
                place = include / self.name / header.relative_to(self.source / kind)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(header, place)
        self.includes = [
            f'-I{include}',
            f'-I{VENV / "include"}',
            *(f'-I{path}' for path in sorted((VENV / 'include').iterdir()) if path.is_dir()),
            f'-I{sysconfig.get_path("include")}',
            f'-I{np.get_include()}',
        ]
        (self.built / 'lib').mkdir(parents=True)
        own = f'{self.name}__rosidl_generator_c'
        runtime = ['rosidl_runtime_c', 'rosidl_typesupport_c', 'rcutils']
        self.link_library(own, (self.source / 'c/msg/detail').glob('*.c'),
                          [*self.name_libraries('rosidl_generator_c'), *runtime])  # fmt: skip
        self.link_library(
            f'{self.name}__rosidl_typesupport_fastrtps_c',
            (self.source / 'fastrtps_c').rglob('*.cpp'),
            [own, *self.name_libraries('rosidl_typesupport_fastrtps_c'), 'fastcdr', 'rmw',
             'rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_fastrtps_cpp'],
        )  # fmt: skip
        self.link_library(
            f'{self.name}__rosidl_typesupport_introspection_c',
            (self.source / 'introspection_c').rglob('*.c'),
            [own, *self.name_libraries('rosidl_typesupport_introspection_c'),
             'rosidl_typesupport_introspection_c'],
        )  # fmt: skip
        self.link_library(f'{self.name}__rosidl_typesupport_c',
                          (self.source / 'c/msg').glob('*.cpp'), [own, *runtime])  # fmt: skip
        self.link_library(f'{self.name}__rosidl_generator_py',
                          (self.source / 'py/msg').glob('*.c'),
                          [own, *self.name_libraries('rosidl_generator_py')])  # fmt: skip
        for kind in ('rosidl_typesupport_c', *TYPESUPPORTS):
            self.link_extension(kind, runtime)

    def name_libraries(self, kind: str) -> list[str]:
        """Return the libraries of one kind of the packages whose messages are used."""
        return [f'{package}__{kind}' for package in self.uses]

    def link_library(self, name: str, sources: Iterable[Path], libraries: list[str]) -> None:
        """Compile sources into a library that lies beside those of the wheels."""
        self.link(self.built / 'lib' / f'lib{name}.so', sources, libraries, '$ORIGIN')

    def link_extension(self, kind: str, runtime: list[str]) -> None:
        """Compile the Python extension of one type support."""
        out = self.built / 'python' / self.name / f'{self.name}_s__{kind}.so'
        out.parent.mkdir(parents=True, exist_ok=True)
        source = self.source / 'py' / f'_{self.name}_s.ep.{kind}.c'
        depth = '/'.join('..' for _ in SITE.relative_to(VENV).parts)
        libraries = [f'{self.name}__rosidl_generator_py', f'{self.name}__{kind}', *runtime]
        self.link(out, [source], libraries, f'$ORIGIN/../{depth}/lib')

    def link(self, out: Path, sources: Iterable[Path], libraries: list[str], search: str) -> None:
        """Compile sources and link them; `search` is where the loader looks for libraries."""
        objects = []
        for source in sources:
            made = self.work / f'{out.stem}-{len(objects)}.o'
            plain = source.suffix == '.c'
            # The generated code is not ours to warn about
            run([*(['cc'] if plain else ['c++', '-std=c++17']), '-O2', '-fPIC', '-w',
                 *self.includes, '-c', source, '-o', made])  # fmt: skip
            objects.append(made)
        run(
            [
                'c++',
                '-shared',
                '-o',
                out,
                *objects,
                f'-L{self.built / "lib"}',
                f'-L{VENV / "lib"}',
                *(f'-l{each}' for each in libraries),
                f'-Wl,-rpath,{search}',
            ]
        )

    def install(self) -> None:
        """Copy libraries, interface files and Python package to .venv, what is imported last."""
        copy_files(self.built / 'lib', VENV / 'lib')
        share = VENV / 'share' / self.name
        copy_files(self.folder, share)
        copy_files(self.source / 'c/tmp/msg', share / 'msg')
        index = VENV / 'share/ament_index/resource_index'
        interfaces = sorted(f'msg/{path.name}' for path in (share / 'msg').iterdir())
        (index / 'packages' / self.name).write_text('')
        (index / 'rosidl_interfaces' / self.name).write_text('\n'.join(interfaces))
        with TemporaryDirectory(dir=SITE) as near:
            made = Path(near, self.name)
            shutil.copytree(self.built / 'python' / self.name, made)
            shutil.copytree(self.source / 'py/msg', made / 'msg',
                            ignore=shutil.ignore_patterns('*.c'))  # fmt: skip
            (made / '__init__.py').touch()
            shutil.rmtree(SITE / self.name, ignore_errors=True)
            made.rename(SITE / self.name)


def copy_files(source: Path, target: Path) -> None:
    """Copy a folder into another; a process that has loaded an old library keeps it."""

    def copy(file: str, place: str) -> None:
        shutil.copy(file, f'{place}.new')
        Path(f'{place}.new').replace(place)

    shutil.copytree(source, target, copy_function=copy, dirs_exist_ok=True)


@contextmanager
def lock_environment() -> Iterator[None]:
    """Wait until no other build installs into .venv."""
    folder = os.open(SITE, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)


def run(command: list[object]) -> None:
    """Run a command; on failure print its messages and exit."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f'{done.stderr}\n{command[0]} failed; see above.')


def main() -> None:
    """Build the packages in the given folders."""
    folders = [Path(each).absolute() for each in sys.argv[1:]]
    names = ', '.join(each.name for each in folders)
    if missing := find_missing():
        sys.stdout.write(f'messages: {names} not built: this machine lacks {missing}.\n')
        sys.exit(UNAVAILABLE)
    sys.stdout.write(f'messages: {names} (ten seconds) ...\n')
    sys.stdout.flush()
    use_each_entry_point_once()
    try:
        for folder in folders:
            with TemporaryDirectory() as work:
                package = MessagePackage(folder, Path(work))
                package.generate()
                package.compile()
                with lock_environment():
                    package.install()
    except OSError as error:
        sys.exit(f'messages: {names} not built: {error}.')


if __name__ == '__main__':
    main()
