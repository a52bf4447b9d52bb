"""Supervision of real, tiny processes: ends are named, signals come in order, nothing is left."""

from collections.abc import Callable
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
import threading
import time

from lta_config.errors import BadInput
from lta_graph.launch_file import LaunchPlan, Process
from lta_graph.launcher import Launcher
import pytest

pytestmark = pytest.mark.flaky(reruns=2)  # real processes against the wall clock
MARKERS = 'share/ament_index/resource_index/packages'
FOREVER = 'import time\nprint("up", flush=True)\ntime.sleep(600)\n'
# Handlers write with os.write: a signal may come while `print` still holds its buffer.
DEAF = """
import os, signal, time
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda got, _: os.write(1, f'{signal.Signals(got).name}\\n'.encode()))
os.write(1, b'up\\n')
while True:
    time.sleep(600)
"""
IGNORANT = """
import signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
print('up', flush=True)
time.sleep(600)
"""
POLITE = """
import os, signal, time
def leave(number, _):
    os.write(1, b'closing\\n')
    time.sleep(0.3)
    os.write(1, b'closed\\n')
    os._exit(0)
signal.signal(signal.SIGINT, leave)
os.write(1, b'up\\n')
time.sleep(600)
"""


class Fleet:
    """A package of throw-away executables, and the lines that they wrote."""

    def __init__(self, prefix: Path) -> None:
        self.folder = prefix / 'lib' / 'fleet'
        self.folder.mkdir(parents=True)
        (prefix / MARKERS).mkdir(parents=True)
        (prefix / MARKERS / 'fleet').touch()
        self.lines: list[tuple[str, str]] = []
        self.processes: list[Process] = []

    def add(self, name: str, code: str, *, ends_run: bool = False, args: tuple[str, ...] = ()):
        path = self.folder / name
        path.write_text(f'#!{sys.executable} -IS\n{code}', encoding='utf-8')
        path.chmod(0o755)
        self.processes.append(Process('fleet', name, name, '/', args, ends_run))

    def launcher(self, grace: float = 5.0, spare: tuple[str, ...] = ()) -> Launcher:
        plan = LaunchPlan(tuple(self.processes))
        return Launcher(plan, lambda *line: self.lines.append(line), grace=grace, spare=spare)

    def await_line(self, *line: str) -> None:
        until(lambda: line in self.lines)

    def pids(self) -> list[int]:
        return pids_of(self.folder)


def pids_of(folder: Path) -> list[int]:
    """The living processes that run something in a folder, as the system sees them."""
    found = []
    for entry in Path('/proc').iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / 'cmdline').read_bytes()
                state = (entry / 'stat').read_text().rsplit(')', 1)[1].split()[0]
            except OSError:
                continue
            if f'{folder}/'.encode() in words and state != 'Z':
                found.append(int(entry.name))
    return found


def until(true: Callable[[], bool], seconds: float = 10.0) -> None:
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, 'it did not happen in time'
        time.sleep(0.005)


@pytest.fixture
def fleet(tmp_path, monkeypatch):
    made = Fleet(tmp_path / 'prefix')
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path / 'prefix'))
    yield made
    left = made.pids()
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left, 'processes were left behind'


def run_to_end(launcher: Launcher) -> None:
    until(lambda: bool(launcher.wait(1.0)) and launcher.outcome is not None)


def test_a_killed_process_is_named_within_half_a_second(fleet):
    fleet.add('estimator', FOREVER)
    fleet.add('controller', FOREVER)
    with fleet.launcher() as launcher:
        fleet.await_line('estimator', 'up')
        fleet.await_line('controller', 'up')
        assert sorted(launcher.running) == ['controller', 'estimator']
        assert launcher.poll() == []
        (victim,) = [pid for pid in fleet.pids() if b'estimator' in _cmdline(pid)]
        os.kill(victim, signal.SIGKILL)
        killed = time.monotonic()
        (ended,) = launcher.wait(5.0)
        assert time.monotonic() - killed < 0.5
        assert ended.sentence == 'estimator was killed by SIGKILL'
        assert (ended.status, ended.success, ended.stopped) == (-9, False, False)
        assert launcher.outcome is ended
        assert launcher.running == ['controller']


def _cmdline(pid: int) -> bytes:
    return Path(f'/proc/{pid}/cmdline').read_bytes()


def test_the_last_twenty_lines_of_each_stream_survive_a_crash(fleet):
    fleet.add(
        'navigator',
        'import sys\nfor k in range(50): print("out", k)\n'
        'for k in range(30): print("err", k, file=sys.stderr)\n'
        'sys.stderr.write("no newline \\u2603")\nsys.exit(7)\n',
    )
    with fleet.launcher() as launcher:
        run_to_end(launcher)
    ended = launcher.outcome
    assert ended.sentence == 'navigator ended with status 7'
    assert ended.stdout == tuple(f'out {k}' for k in range(30, 50))
    assert ended.stderr == (*(f'err {k}' for k in range(11, 30)), 'no newline \N{SNOWMAN}')
    assert ended.lines == ended.stderr
    assert len(fleet.lines) == 81


@pytest.mark.parametrize(
    ('status', 'ends_run', 'success', 'sentence'),
    [
        (0, True, True, 'simulator ended'),
        (0, False, False, 'simulator ended'),
        (1, True, False, 'simulator ended with status 1'),
        (2, False, False, 'simulator ended with status 2'),
    ],
)
def test_only_status_0_of_the_process_that_ends_the_run_is_success(
    fleet, status, ends_run, success, sentence
):
    fleet.add('simulator', f'raise SystemExit({status})', ends_run=ends_run)
    fleet.add('recorder', POLITE)
    with fleet.launcher() as launcher:
        run_to_end(launcher)
        fleet.await_line('recorder', 'up')
        assert (launcher.outcome.success, launcher.outcome.sentence) == (success, sentence)
    # The recorder was asked to end: that does not change the outcome.
    assert (launcher.outcome.name, launcher.outcome.success) == ('simulator', success)
    assert [(end.name, end.status, end.stopped) for end in launcher.ended] == [
        ('simulator', status, False),
        ('recorder', 0, True),
    ]


def test_without_a_spare_process_the_run_goes_on(fleet):
    fleet.add('viewer', 'raise SystemExit(2)')
    fleet.add('simulator', FOREVER)
    with fleet.launcher(spare=('viewer',)) as launcher:
        until(lambda: bool(launcher.wait(1.0)))
        (ended,) = launcher.ended
        assert (ended.name, ended.status, ended.stopped) == ('viewer', 2, False)
        assert launcher.outcome is None
        fleet.await_line('simulator', 'up')
        (victim,) = [pid for pid in fleet.pids() if b'simulator' in _cmdline(pid)]
        os.kill(victim, signal.SIGKILL)
        run_to_end(launcher)
        assert launcher.outcome.name == 'simulator'


def test_a_spare_process_that_hangs_does_not_hold_up_the_end(fleet):
    fleet.add('viewer', DEAF)
    fleet.add('recorder', POLITE)
    with fleet.launcher(grace=60.0, spare=('viewer',)) as launcher:
        for name in ('viewer', 'recorder'):
            fleet.await_line(name, 'up')
        before = time.monotonic()
    assert time.monotonic() - before < 30.0
    assert {end.name: end.status for end in launcher.ended} == {
        'recorder': 0,
        'viewer': -signal.SIGKILL,
    }
    assert ('recorder', 'closed') in fleet.lines


def test_stop_gives_time_to_close(fleet):
    fleet.add('recorder', POLITE)
    with fleet.launcher() as launcher:
        fleet.await_line('recorder', 'up')
        before = time.monotonic()
    assert 0.3 <= time.monotonic() - before < 2.0
    assert fleet.lines == [('recorder', 'up'), ('recorder', 'closing'), ('recorder', 'closed')]
    assert launcher.outcome is None
    assert [(end.status, end.stopped) for end in launcher.ended] == [(0, True)]


def test_signals_come_in_order_after_their_graces(fleet, monkeypatch):
    monkeypatch.setattr('lta_graph.launcher.TERM_GRACE', 0.2)
    fleet.add('deaf', DEAF)
    launcher = fleet.launcher(grace=0.4)
    launcher.start()
    fleet.await_line('deaf', 'up')
    before = time.monotonic()
    launcher.stop()
    assert 0.6 <= time.monotonic() - before < 1.5
    assert [line for _, line in fleet.lines] == ['up', 'SIGINT', 'SIGTERM']
    (ended,) = launcher.ended
    assert (ended.sentence, ended.stopped) == ('deaf was killed by SIGKILL', True)
    launcher.stop()  # again is nothing


def test_children_of_a_process_end_with_it(fleet):
    fork = 'import os, time\nif os.fork():\n    time.sleep(600)\n'
    fleet.add('parent', fork + IGNORANT)
    with fleet.launcher():
        fleet.await_line('parent', 'up')
        assert len(fleet.pids()) == 2
    assert fleet.pids() == []


def test_a_flood_of_output_neither_blocks_nor_hides_a_death(fleet):
    fleet.add(
        'flood', 'import os\nblock = b"x" * 79 + b"\\n"\nwhile True: os.write(1, 500 * block)'
    )
    fleet.add('endless', 'import os\nwhile True: os.write(2, b"x" * 40000)')  # never a line's end
    fleet.add('mortal', 'import time\ntime.sleep(0.5)\nraise SystemExit(4)')
    count = {'flood': 0, 'endless': 0}

    def add(name: str, line: str) -> None:
        count[name] += len(line)

    started = time.monotonic()
    with Launcher(LaunchPlan(tuple(fleet.processes)), add) as launcher:
        run_to_end(launcher)
        assert launcher.outcome.sentence == 'mortal ended with status 4'
        assert time.monotonic() - started < 2.5
    assert count['flood'] > 1_000_000
    assert count['endless'] > 1_000_000
    assert time.monotonic() - started < 5.0


def test_a_process_gets_its_arguments_and_environment(fleet):
    fleet.add(
        'show',
        'import os, sys\nprint(sys.argv[1:], os.environ["PYTHONUNBUFFERED"],\n'
        '      os.environ["OPENBLAS_NUM_THREADS"], os.getsid(0) == os.getpid(),\n'
        '      os.getpgid(0) == os.getpid(), sys.stdin.read() == "")',
        args=('--ros-args', '-p', 'text:="a b"'),
    )
    with fleet.launcher() as launcher:
        run_to_end(launcher)
    shown = "['--ros-args', '-p', 'text:=\"a b\"'] 1 1 True True True"
    assert fleet.lines == [('show', shown)]


def test_what_cannot_be_executed_starts_nothing(fleet):
    fleet.add('good', FOREVER)
    fleet.add('bad', '')
    (fleet.folder / 'bad').write_text('#!/no/such/interpreter\n')
    with pytest.raises(BadInput, match=r'^bad cannot be started: .*/bad: No such file'):
        fleet.launcher().start()
    assert fleet.pids() == []
    (fleet.folder / 'bad').chmod(0o644)
    with pytest.raises(BadInput, match=r"^Unknown executable of fleet 'bad'; known: good\.$"):
        fleet.launcher().start()
    fleet.processes = [Process('nowhere', 'x', 'x', '/', (), False)]
    with pytest.raises(
        BadInput,
        match=r"^(Unknown package 'nowhere'; known: lta_|Package 'nowhere' is not in .*build)",
    ):
        fleet.launcher().start()


def test_an_error_in_the_callback_reaches_the_caller_and_stops_all(fleet):
    fleet.add('talker', FOREVER)

    def fail(name: str, line: str) -> None:
        raise OSError('the terminal is gone')

    def run() -> None:
        with Launcher(LaunchPlan(tuple(fleet.processes)), fail) as launcher:
            for _ in range(100):
                launcher.wait(0.05)

    with pytest.raises(OSError, match='the terminal is gone'):
        run()
    assert fleet.pids() == []


def test_a_hanging_callback_does_not_hold_the_stop_up(fleet):
    fleet.add('talker', FOREVER)
    hang = threading.Event()
    launcher = Launcher(LaunchPlan(tuple(fleet.processes)), lambda *_: hang.wait() and None)
    launcher.start()
    until(lambda: len(fleet.pids()) == 1)
    before = time.monotonic()
    launcher.stop()
    assert time.monotonic() - before < 3.0
    assert fleet.pids() == []
    hang.set()


LAUNCH = """
import os, sys
from lta_graph.launch_file import LaunchPlan, Process
from lta_graph import launcher
launcher.TERM_GRACE = 0.5
plan = LaunchPlan(tuple(Process('fleet', n, n, '/', (), False) for n in sys.argv[2:]))
def say(*words):  # one write a line: two threads speak here
    os.write(1, (' '.join(words) + '\\n').encode())
try:
    with launcher.Launcher(plan, say, grace=float(sys.argv[1])) as it:
        say('started')
        while it.outcome is None:
            it.wait(0.2)
except KeyboardInterrupt:
    say('interrupted')
    sys.exit(130)
"""


class Program:
    """A launcher in a process of its own, to which signals can be sent."""

    def __init__(self, grace: float, *names: str) -> None:
        path = ':'.join(item for item in sys.path if item)
        self.popen = subprocess.Popen(
            [sys.executable, '-c', LAUNCH, str(grace), *names],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, 'PYTHONPATH': path},
        )
        self._watchdog = threading.Timer(20.0, self.popen.kill)  # so that no test can hang
        self._watchdog.start()

    def read_until(self, *wanted: str) -> None:
        missing = set(wanted)
        while missing:
            line = self.popen.stdout.readline()
            assert line, f'it ended without {missing}'
            missing.discard(line.strip())

    def rest(self) -> tuple[int, list[str]]:
        out, _ = self.popen.communicate(timeout=10)
        self._watchdog.cancel()
        return self.popen.returncode, out.splitlines()


def test_ctrl_c_ends_everything_in_order(fleet):
    fleet.add('recorder', POLITE)
    fleet.add('simulator', FOREVER)
    program = Program(5.0, 'recorder', 'simulator')
    program.read_until('started', 'recorder up', 'simulator up')
    program.popen.send_signal(signal.SIGINT)
    status, lines = program.rest()
    assert status == 130
    assert [line for line in lines if 'clos' in line] == ['recorder closing', 'recorder closed']
    assert lines[-1] == 'interrupted'
    assert fleet.pids() == []


def test_a_second_ctrl_c_shortens_the_grace(fleet):
    fleet.add('deaf', DEAF)
    program = Program(60.0, 'deaf')
    program.read_until('started', 'deaf up')
    program.popen.send_signal(signal.SIGINT)
    before = time.monotonic()
    program.read_until('deaf SIGINT')
    program.popen.send_signal(signal.SIGINT)
    program.read_until('deaf SIGTERM')
    status, lines = program.rest()
    assert time.monotonic() - before < 5.0
    assert (status, lines[-1]) == (130, 'interrupted')
    assert fleet.pids() == []


@pytest.mark.parametrize('delay', [0.02, 0.08, 0.12, 0.16, 0.2, 0.25])
def test_ctrl_c_while_starting_leaves_nothing(fleet, delay):
    names = [f'node{k}' for k in range(7)]
    for name in names:
        fleet.add(name, FOREVER)
    program = Program(5.0, *names)
    time.sleep(delay)
    program.popen.send_signal(signal.SIGINT)
    assert program.rest()[0] in (130, -signal.SIGINT, 1)  # 1, -2: before the program's own `try`
    until(lambda: not fleet.pids(), 1.0)


def test_a_killed_launcher_takes_its_processes_along(fleet):
    fleet.add('polite', FOREVER)
    program = Program(5.0, 'polite')
    program.read_until('started', 'polite up')
    program.popen.kill()
    program.rest()
    until(lambda: not fleet.pids(), 1.0)


def test_a_killed_launcher_takes_also_along_who_ignores_sigint(fleet):
    fleet.add('deaf', IGNORANT)
    program = Program(0.1, 'deaf')
    program.read_until('started', 'deaf up')
    program.popen.kill()
    killed = time.monotonic()
    until(lambda: not fleet.pids(), 5.0)
    assert 0.4 < time.monotonic() - killed < 3.0  # 0.1 s and the 0.5 s after SIGTERM
    program.rest()


def test_nothing_of_the_guard_is_left_after_a_stop(fleet):
    fleet.add('node', FOREVER)
    with fleet.launcher() as launcher:
        guard = launcher._guard._popen.pid
        assert Path(f'/proc/{guard}').exists()
    assert not Path(f'/proc/{guard}').exists()


def test_ctrl_c_is_heard_even_where_a_shell_has_it_ignored(fleet):
    # A shell without job control starts background jobs with SIGINT ignored; heirs inherit it.
    fleet.add('node', FOREVER)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with fleet.launcher(grace=5.0) as launcher:
            fleet.await_line('node', 'up')
            started = time.monotonic()
        assert time.monotonic() - started < 2.0
    finally:
        signal.signal(signal.SIGINT, before)
    assert re.fullmatch(
        r'node (was killed by SIGINT|ended with status 1)', launcher.ended[0].sentence
    )
