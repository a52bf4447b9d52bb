# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Generate and compile messages, services and actions that no wheel has; install them into .venv.

    .venv/bin/python tools/messages.py FOLDER ...

Each folder has a package.xml and msg/*.msg, srv/*.srv or action/*.action. The generators are those
of ROS 2, which come with its wheels; they write C and C++. Where the machine has no compiler, that
of `ziglang` is installed into .venv (100 MB). After a failure nothing was changed.
"""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager, redirect_stdout
import fcntl
from functools import partial
from graphlib import TopologicalSorter
from importlib import metadata
from importlib.util import find_spec
import io
import multiprocessing
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
import sysconfig
from tempfile import TemporaryDirectory
import time
from xml.etree import ElementTree

import numpy as np

VENV = Path(sys.prefix)
SITE = Path(sysconfig.get_path('purelib'))
TYPESUPPORTS = ('rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_introspection_c')
KINDS = ('msg', 'srv', 'action')
GENERATORS = (
    ('types', 'py'),
    ('types', 'c'),
    ('typesupports', 'c'),
    ('typesupports', 'fastrtps_c'),
    ('typesupports', 'introspection_c'),
)
# What the messages use of which a service or an action is made, by its kind
IMPLIED = {
    'msg': (),
    'srv': ('builtin_interfaces', 'service_msgs'),
    'action': ('action_msgs', 'builtin_interfaces', 'service_msgs', 'unique_identifier_msgs'),
}
COMPILERS = (('cc', 'c++'), ('gcc', 'g++'), ('clang', 'clang++'))  # of C and C++
STANDARDS = {'.c': '-std=gnu17', '.cpp': '-std=c++17'}  # by suffix of the source
LOCKED_COMPILER = Path(__file__).resolve().parents[1] / 'locked/compiler.txt'
CORES = len(os.sched_getaffinity(0))


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


def find_compilers() -> dict[str, list[str]]:
    """Return the commands that compile C and C++, by suffix: the machine's, or ziglang's."""
    for pair in COMPILERS:
        if all(map(shutil.which, pair)):
            return {suffix: [name] for suffix, name in zip(STANDARDS, pair, strict=True)}
    if find_spec('ziglang') is None:
        install_compiler()
    zig = [sys.executable, '-P', '-m', 'ziglang']
    # Exceptions of Fast CDR, which is of another C++ library, only pass through the generated code
    return {'.c': [*zig, 'cc'], '.cpp': [*zig, 'c++', '-fignore-exceptions']}


def install_compiler() -> None:
    """Install the compiler of ziglang into .venv; exit with the remedy if it cannot be had."""
    sys.stdout.write('messages: no C++ compiler here; fetching ziglang (100 MB) ...\n')
    sys.stdout.flush()
    pip = [sys.executable, '-P', '-m', 'pip', 'install', '--disable-pip-version-check',
           '--no-input', '--no-compile', '--no-deps', '--require-hashes']  # fmt: skip
    done = subprocess.run(
        [*pip, '--requirement', str(LOCKED_COMPILER)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        errors = re.findall(r'^ERROR: (.*)', done.stderr, re.MULTILINE)
        sys.exit(
            f'messages: this machine has no C++ compiler, and ziglang cannot be installed '
            f'({errors[0] if errors else "pip failed"}); install one (Debian, Ubuntu: sudo apt '
            'install g++), or check the network and the pip configuration, and run make again.'
        )


def check_headers() -> None:
    """Exit with the remedy if the headers of Python are missing."""
    if not Path(sysconfig.get_path('include'), 'Python.h').is_file():
        sys.exit(
            'messages: this machine lacks the headers of Python; install them (Debian, Ubuntu: '
            'sudo apt install python3-dev), or name a Python that has them (make '
            'PYTHON=/path/to/python3), and run make again.'
        )


class MessagePackage:
    """
    A package of messages, services and actions, its generated sources and its libraries.

    Parameters
    ----------
    folder : Path
        Folder with package.xml, msg/*.msg, srv/*.srv and action/*.action.
    compilers : dict of str to list of str
        Commands that compile, by suffix of the source.

    """

    def __init__(self, folder: Path, compilers: dict[str, list[str]]) -> None:
        self.folder = folder
        self.compilers = compilers
        self.name = str(ElementTree.parse(folder / 'package.xml').findtext('name'))
        self.files = [
            path.relative_to(folder)
            for kind in KINDS
            for path in sorted(folder.glob(f'{kind}/*.{kind}'))
        ]
        self.kinds = sorted({path.parent.name for path in self.files})
        uses = {
            package
            for path in self.files
            for package in re.findall(
                r'^(\w+)/\w', (folder / path).read_text('utf-8'), re.MULTILINE
            )
        }
        for kind in self.kinds:
            uses.update(IMPLIED[kind])
        self.uses = sorted(uses - {self.name})

    def build(self, work: Path) -> None:
        """Generate, compile and install it, with an empty folder for what is in between."""
        self.source, self.built = work / 'source', work / 'built'
        self.generate()
        self.compile()
        self.make_package()
        with lock_environment():
            self.install()

    def generate(self) -> None:
        """Write the sources in C, C++ and Python."""
        fork = multiprocessing.get_context('fork')
        with ProcessPoolExecutor(CORES, mp_context=fork) as pool:
            for started in [pool.submit(self.run_generator, *each) for each in GENERATORS]:
                started.result()

    def run_generator(self, kind: str, name: str) -> None:
        """Write the sources of one generator of types or type supports."""
        from rosidl_cli.command.generate.api import generate

        os.chdir(self.folder)
        # The generators print each file that they read
        with redirect_stdout(io.StringIO()):
            generate(
                package_name=self.name,
                interface_files=[str(path) for path in self.files],
                include_paths=[str(VENV / 'share')],
                output_path=self.source / name,
                **{kind: [name]},
            )

    def compile(self) -> None:
        """Compile all libraries."""
        include = self.built / 'include' / self.name
        for kind in ('c', 'fastrtps_c', 'introspection_c'):
            for header in (self.source / kind).rglob('*.h'):
                place = include / self.name / header.relative_to(self.source / kind)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(header, place)
        includes = [
            f'-I{include}',
            f'-I{VENV / "include"}',
            *(f'-I{path}' for path in sorted((VENV / 'include').iterdir()) if path.is_dir()),
            f'-I{sysconfig.get_path("include")}',
            f'-I{np.get_include()}',
        ]
        with ThreadPoolExecutor(CORES) as pool:
            compile_one = partial(compile_object, self.compilers, includes)
            for _ in pool.map(compile_one, self.list_sources('*')):
                pass
        self.link_libraries()

    def list_sources(self, part: str) -> list[Path]:
        """Return the sources to compile in a part of the generated ones."""
        found = sorted(self.source.glob(f'{part}/**/*.c*'))
        return [path for path in found if path.suffix in STANDARDS]

    def link_libraries(self) -> None:
        """Link the compiled sources, each library after those that it uses."""
        (self.built / 'lib').mkdir(parents=True)
        own = f'{self.name}__rosidl_generator_c'
        runtime = ['rosidl_runtime_c', 'rosidl_typesupport_c', 'rcutils']
        in_c = self.list_sources('c')
        self.link_library(own, [path for path in in_c if path.suffix == '.c'],
                          [*self.name_libraries('rosidl_generator_c'), *runtime])  # fmt: skip
        self.link_library(
            f'{self.name}__rosidl_typesupport_fastrtps_c',
            self.list_sources('fastrtps_c'),
            [own, *self.name_libraries('rosidl_typesupport_fastrtps_c'), 'fastcdr', 'rmw',
             'rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_fastrtps_cpp'],
        )  # fmt: skip
        self.link_library(
            f'{self.name}__rosidl_typesupport_introspection_c',
            self.list_sources('introspection_c'),
            [own, *self.name_libraries('rosidl_typesupport_introspection_c'),
             'rosidl_typesupport_introspection_c'],
        )  # fmt: skip
        self.link_library(
            f'{self.name}__rosidl_typesupport_c',
            [path for path in in_c if path.suffix == '.cpp'],
            [own, *self.name_libraries('rosidl_typesupport_c'), *runtime],
        )
        self.link_library(
            f'{self.name}__rosidl_generator_py',
            [path for kind in self.kinds for path in self.list_sources(f'py/{kind}')],
            [own, *self.name_libraries('rosidl_generator_py')],
        )
        for kind in ('rosidl_typesupport_c', *TYPESUPPORTS):
            self.link_extension(kind, runtime)

    def name_libraries(self, kind: str) -> list[str]:
        """Return the libraries of one kind of the packages whose messages are used."""
        return [f'{package}__{kind}' for package in self.uses]

    def link_library(self, name: str, sources: list[Path], libraries: list[str]) -> None:
        """Link sources to a library that lies beside those of the wheels."""
        self.link(self.built / 'lib' / f'lib{name}.so', sources, libraries, '$ORIGIN')

    def link_extension(self, kind: str, runtime: list[str]) -> None:
        """Link the Python extension of one type support."""
        out = self.built / 'python' / f'{self.name}_s__{kind}.so'
        out.parent.mkdir(exist_ok=True)
        source = self.source / 'py' / f'_{self.name}_s.ep.{kind}.c'
        depth = '/'.join('..' for _ in SITE.relative_to(VENV).parts)
        libraries = [f'{self.name}__rosidl_generator_py', f'{self.name}__{kind}', *runtime]
        self.link(out, [source], libraries, f'$ORIGIN/../{depth}/lib')

    def link(self, out: Path, sources: list[Path], libraries: list[str], search: str) -> None:
        """Link compiled sources; `search` is where the loader looks for libraries."""
        run(
            [
                *self.compilers['.cpp'],
                '-shared',
                '-o',
                out,
                *(name_object(path) for path in sources),
                f'-L{self.built / "lib"}',
                f'-L{VENV / "lib"}',
                *(f'-l{each}' for each in libraries),
                f'-Wl,-rpath,{search}',
            ]
        )

    def make_package(self) -> None:
        """Lay out the Python package and the interface files as they are installed."""
        (self.built / 'share').mkdir()
        shutil.copy(self.folder / 'package.xml', self.built / 'share')
        for kind in self.kinds:
            # The interface files in the language of the generators, then as they were written
            shutil.copytree(self.source / 'c/tmp' / kind, self.built / 'share' / kind)
            shutil.copytree(self.source / 'py' / kind, self.built / 'python' / kind,
                            ignore=shutil.ignore_patterns('*.c', '*.o'))  # fmt: skip
        for path in self.files:
            shutil.copy(self.folder / path, self.built / 'share' / path)
        (self.built / 'python/__init__.py').touch()

    def install(self) -> None:
        """Copy libraries, interface files and Python package to .venv, what is imported last."""
        copy_files(self.built / 'lib', VENV / 'lib')
        replace_folder(self.built / 'share', VENV / 'share' / self.name)
        index = VENV / 'share/ament_index/resource_index'
        listed = sorted(f'{path.parent}/{path.stem}.{suffix}'
                        for path in self.files for suffix in ('idl', path.suffix[1:]))  # fmt: skip
        (index / 'packages' / self.name).write_text('')
        (index / 'rosidl_interfaces' / self.name).write_text('\n'.join(listed))
        replace_folder(self.built / 'python', SITE / self.name)


def compile_object(compilers: dict[str, list[str]], includes: list[str], source: Path) -> None:
    """Compile one generated source; its code is not ours to warn about."""
    command = [*compilers[source.suffix], STANDARDS[source.suffix]]
    # Zig would add checks of undefined behaviour, which need a library of its own
    flags = ['-O1', '-fPIC', '-w', '-fno-sanitize=undefined', *includes]
    run([*command, *flags, '-c', source, '-o', name_object(source)])


def name_object(source: Path) -> Path:
    """Return the object file of a source; two sources differ in no more than their suffix."""
    return source.with_name(f'{source.name}.o')


def replace_folder(source: Path, target: Path) -> None:
    """Replace a folder by the copy of another, after that was written completely."""
    with TemporaryDirectory(dir=target.parent) as near:
        made = Path(near, target.name)
        shutil.copytree(source, made)
        shutil.rmtree(target, ignore_errors=True)
        made.rename(target)


def order_packages(packages: list[MessagePackage]) -> list[MessagePackage]:
    """Return packages with each after those that it uses."""
    by_name = {each.name: each for each in packages}
    graph = {each.name: [name for name in each.uses if name in by_name] for each in packages}
    return [by_name[name] for name in TopologicalSorter(graph).static_order()]


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
    # Zig compiles its C++ library once, in a minute or two; what make creates lies in .venv
    variables = {**os.environ, 'ZIG_GLOBAL_CACHE_DIR': str(VENV / 'zig_cache')}
    words = list(map(str, command))
    done = subprocess.run(words, env=variables, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f'{done.stderr}\n{command[0]} failed; see above.')


def main() -> None:
    """Build the packages in the given folders."""
    folders = [Path(each).absolute() for each in sys.argv[1:]]
    names = ', '.join(each.name for each in folders)
    check_headers()
    compilers = find_compilers()
    begun = time.monotonic()
    sys.stdout.write(f'messages: {names} (10 to 30 s) ...\n')
    sys.stdout.flush()
    use_each_entry_point_once()
    try:
        for package in order_packages([MessagePackage(each, compilers) for each in folders]):
            with TemporaryDirectory() as work:
                package.build(Path(work))
    except OSError as error:
        sys.exit(f'messages: {names} not built: {error}.')
    sys.stdout.write(f'messages: ready (took {time.monotonic() - begun:.0f} s).\n')


if __name__ == '__main__':
    main()
