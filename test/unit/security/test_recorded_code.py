# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Code that a recording names is not run by any command that reads the recording."""

from lta_config.files import find_file
import pytest

SPY = 'open("ran", "w").close()\n'
NAMED = {  # what a stranger writes into the provenance of a recording
    'set': 'mission.strategy={}',
    'strategy': '{}',
    'vehicle': '{}',
    'scenario': '{}',
    'gains': '{}',
    'commands': '{}',
    'replay_of': '{}',
    'time': '{}',
    'robots': '{}',
}
READING = (
    ('compare', '--no-page'),
    ('report',),
    ('bag', 'info'),
    ('bag', 'check'),
    ('vehicle', 'trim'),
)
SIMULATE = ('simulate', '--out', 'again', '--commands')
REPLAY = ('replay', '--nodes', 'navigator,demodulator', '--out', 'again')
CASES = [
    *((SIMULATE, [key]) for key in NAMED),
    *((words, [key for key in NAMED if key != 'robots']) for words in READING),
    # It refuses the others, below
    (REPLAY, [key for key in NAMED if key not in ('set', 'strategy', 'robots')]),
]


@pytest.fixture
def gift(record, types):
    """Return a function that records in a folder, as it is unpacked from a zip."""

    def build(**provenance):
        messages = [
            (f'/lta1/{name}', 'std_msgs/msg/Bool', types['std_msgs/msg/Bool'](True), time)
            for name in ('energy/reserve', 'odom', 'photodiodes')
            for time in (10**9, 2 * 10**9)
        ]
        bag = record(messages, provenance=provenance)
        (bag.parent / 'gift').mkdir()
        (bag.parent / 'gift' / 'nav.py').write_text(SPY)
        return bag

    return build


@pytest.mark.parametrize(
    ('words', 'keys'), CASES, ids=[f'{words[0]}-{keys[0]}' for words, keys in CASES]
)
def test_nothing_that_a_recording_names_is_run(words, keys, sandbox, gift):
    bag = gift(**{key: NAMED[key].format('gift/nav.py') for key in keys})
    bags = (bag, bag) if words[0] == 'compare' else (bag,)
    told = sandbox.run([*words, *bags], bag.parent)
    assert 'Traceback' not in told.err, told.err[-2000:]
    assert not (bag.parent / 'ran').exists()


@pytest.mark.parametrize(
    ('provenance', 'sentence'),
    [
        (
            {'set': 'mission.strategy=gift/nav.py'},
            "The recording sets 'mission.strategy=gift/nav.py', which lta simulate --set refuses",
        ),
        ({'strategy': 'gift/nav.py'}, "The recording names the strategy 'gift/nav.py', which is"),
        ({'strategy': 'bag', 'strategy_file': SPY}, "The recording names the strategy 'bag'"),
    ],
)
def test_a_replay_says_why_it_does_not_run_it(provenance, sentence, sandbox, gift):
    vehicle = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    bag = gift(vehicle_file=vehicle, **provenance)
    told = sandbox.run(['replay', bag, '--nodes', 'navigator,demodulator'], bag.parent)
    assert told.status == 2
    assert told.err.startswith(sentence)
    assert len(told.err.splitlines()) == 1
    assert sorted(path.name for path in bag.parent.iterdir()) == ['bag', 'gift']
