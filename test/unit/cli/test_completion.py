"""A shell asks how a line goes on, by the protocol of Click, and no command is imported."""

import shlex
import subprocess
import sys

from lta_cli import completion
from lta_cli.completion import complete, load_table
import pytest
import yaml


@pytest.fixture(scope='module', autouse=True)
def _table(tmp_path_factory):
    """Write the table once for all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv('XDG_CACHE_HOME', str(tmp_path_factory.mktemp('cache')))
        load_table()
        yield


@pytest.fixture
def ask(monkeypatch, capsys):
    """Return a function that completes a line in a shell and returns the possible last words."""

    def run(line: str, shell: str = 'bash') -> list[str]:
        words = shlex.split(line) + ([''] if line.endswith(' ') else [])
        monkeypatch.setenv('_LTA_COMPLETE', f'complete_{shell}')
        monkeypatch.setenv('COMP_WORDS', line)
        monkeypatch.setenv('COMP_CWORD', f'{len(words) - 1}')
        monkeypatch.setenv('_TYPER_COMPLETE_ARGS', line)
        monkeypatch.setenv('_TYPER_COMPLETE_FISH_ACTION', 'get-args')
        with pytest.raises(SystemExit) as left:
            complete()
        assert left.value.code == 0
        return capsys.readouterr().out.splitlines()

    return run


@pytest.fixture
def bag(tmp_path):
    """Return a results folder whose bag is only described."""
    (tmp_path / 'bag').mkdir()
    told = [
        {'topic_metadata': {'name': name, 'type': 'std_msgs/msg/Empty'}}
        for name in ('/lta1/odom', '/lta1/light/peaks', '/clock')
    ]
    text = yaml.safe_dump({'rosbag2_bagfile_information': {'topics_with_message_count': told}})
    (tmp_path / 'bag' / 'metadata.yaml').write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ('line', 'expected'),
    [
        ('lta sim', ['simulate']),
        ('lta energy b', ['budget', 'breakeven']),
        ('lta fly --vehicle gt', ['gtmab']),
        ('lta fly --scenario lamp_', ['lamp_room']),
        ('lta fly --strategy h', ['homing']),
        ('lta fly --time ', ['lockstep', 'realtime']),
        ('lta fly --no-p', ['--no-page']),
        ('lta vehicle show rg', ['rgblimp']),
        ('lta vehicle diff gtmab --set trim.h', ['trim.heaviness=']),
        ('lta sweep heav', ['heaviness']),
        ('lta launch fl', ['fleet', 'fly']),
        ('lta launch fly replay', ['replay:=']),
        ('lta effects munk', ['munk_moment']),
        ('lta effects try', ['try']),
        ('lta effects try munk', ['munk_moment']),
        ('lta effects try munk_moment --se', ['--seed']),
        ('lta eff', ['effects']),
        ('lta tests between munk', ['munk_moment']),
        ('lta simulate --set vehicle.trim.h', ['vehicle.trim.heaviness=']),
        ('lta simulate --set mission.des.sc', ['mission.des.scan=']),
        ('lta simulate --set scenario.room.s', ['scenario.room.size=']),
        # The scale of another vehicle's file, which gtmab's has not
        ('lta simulate --vehicle rgblimp --set vehicle.trim.h', ['vehicle.trim.heaviness=']),
        # An effect that the file does not have
        ('lta simulate --set vehicle.effects.cg_offset.x', ['vehicle.effects.cg_offset.x=']),
        ('lta discover --train A B --conf', ['--confirm']),
        # Left to the shell, which knows the files
        ('lta fly --strategy ./', []),
        ('lta fly --vehicle ./absent.yaml --out ', []),
        ('lta simulate --vehicle absent --set vehicle.trim.h', []),
        ('lta bag plot absent ', []),
    ],
)
def test_a_line_goes_on(line, expected, ask):
    assert [word for word in ask(line) if word] == expected


def test_the_topics_are_those_of_the_bag(ask, bag):
    assert ask(f'lta bag plot {bag} ') == ['/clock', 'light/peaks', 'odom']
    assert ask(f'lta bag plot {bag / "bag"} li') == ['light/peaks']


@pytest.mark.parametrize(
    ('line', 'name', 'content'),
    [
        ('lta launch {} ', 'a.launch.py', b"open(__file__ + '.run', 'w')"),
        ('lta bag plot {} ', 'a.mcap', b'\x89MCAP0\r\n' + b'\xff' * 60),
        ('lta vehicle set {} ', 'a.yaml', b'\xff'),
    ],
)
def test_a_file_with_other_contents_gives_nothing_and_is_not_run(
    line, name, content, ask, tmp_path
):
    path = tmp_path / name
    path.write_bytes(content)
    words = [word for word in ask(line.format(path)) if not word.startswith('effects.')]
    assert words == ['']
    assert list(tmp_path.iterdir()) == [path]


def test_zsh_and_fish_show_what_it_is(ask):
    line = 'lta simulate --set vehicle.trim.h'
    assert ask(line, 'fish') == ['vehicle.trim.heaviness=\t2 g']
    assert ask(line, 'zsh') == ["""_arguments '*: :(("vehicle.trim.heaviness=":"2 g"))'"""]


@pytest.mark.parametrize('shell', ['bash', 'zsh', 'fish'])
def test_a_shell_gets_the_script_that_asks(shell, monkeypatch, capsys):
    monkeypatch.setenv('_LTA_COMPLETE', f'source_{shell}')
    with pytest.raises(SystemExit):
        complete()
    said = capsys.readouterr().out
    assert f'_LTA_COMPLETE=complete_{shell}' in said
    assert 'lta' in said


def test_no_command_is_imported():
    """Numba alone takes longer than a person waits."""
    program = (
        'import os, sys\n'
        "os.environ.update(_LTA_COMPLETE='complete_bash', COMP_WORDS='lta fly --vehicle ', "
        "COMP_CWORD='3')\n"
        'from lta_cli.command import main\n'
        'try:\n    main()\n'
        'except SystemExit:\n'
        "    print(sorted({'numba', 'numpy', 'rclpy', 'lta_model'} & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == '[]', done.stderr
    assert 'gtmab' in done.stdout


def test_the_table_is_built_again_only_after_a_change_of_the_code(tmp_path, monkeypatch):
    built = []
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path))
    monkeypatch.setattr(
        'lta_cli.reference.completion.build_table', lambda: built.append(1) or {'settings': {}}
    )
    assert load_table() == load_table()
    assert len(built) == 1
    monkeypatch.setattr(completion, 'compute_code_digest', lambda: 'changed')
    [path] = (tmp_path / 'lta' / 'completion').iterdir()
    for count, stored in enumerate((path.read_text(), '{"comm', '[]', '{}'), 2):
        path.write_text(stored)
        assert load_table() == load_table() == {'settings': {}, 'code': 'changed'}
        assert len(built) == count
    assert list(path.parent.iterdir()) == [path]
