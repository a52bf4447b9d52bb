"""Every benchmark and every score can be imported, so that none breaks unseen."""

import json
import os
from pathlib import Path
import subprocess
import sys

import pytest

TESTS = Path(__file__).resolve().parents[2]
# In one process, as imports take most of the time; what requirements-bench.txt adds may be absent
IMPORT_ALL = """
from importlib import import_module
import json, sys

broken = {}
for name in sys.argv[1:]:
    try:
        import_module(name)
    except ModuleNotFoundError as error:
        if error.name != 'pysindy':
            broken[name] = repr(error)
    except Exception as error:
        broken[name] = repr(error)
print(json.dumps(broken))
"""


@pytest.mark.parametrize('folder', ['benchmark', 'score'])
def test_every_script_is_whole(folder):
    names = [path.stem for path in sorted((TESTS / folder).glob('[!_]*.py'))]
    names = [name for name in names if not name.startswith('test_')]
    path = os.pathsep.join(map(str, (TESTS / folder, TESTS, os.environ['PYTHONPATH'])))
    done = subprocess.run(
        [sys.executable, '-c', IMPORT_ALL, *names],
        env={**os.environ, 'PYTHONPATH': path}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == {}


def test_the_recorder_is_played_the_topics_of_a_flight(monkeypatch):
    """Topics of the graph keep their name, those of a robot get its namespace."""
    monkeypatch.syspath_prepend(str(TESTS / 'benchmark'))
    from record import wired

    topics = wired(None, lambda _kind, topic, _profile: topic)
    assert {'/tf', '/tf_static', '/lta1/imu', '/lta1/motors'} <= topics.keys()
    assert not [topic for topic in topics if '//' in topic]
    assert all(topic == name for name, topic in topics.items())
