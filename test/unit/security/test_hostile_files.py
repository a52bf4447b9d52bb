# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Files of strangers: whatever is in them, a command ends with one sentence and leaves nothing.

Each kind is one function in `texts`, `recordings`, `logs` and `shapes`. None may crash a command,
take more memory than `sandbox` states, hang, run what it holds, or write outside its folder.
"""

import pytest

from .logs import DRAFTED, LOGS
from .logs import TEXTS as CSV_TEXTS
from .recordings import READ, REFUSED
from .sandbox import find_control, MEMORY
from .shapes import SHAPES
from .texts import TEXTS

VEHICLE = ('vehicle', 'show')
CSV = ('import', '--mapping', 'tum', '--out', 'done')
IMPORT = ('import', '--out', 'done')
DRAFT = ('import', '--draft', '--out', 'done')
TUNNEL = ('cfd', 'run', '--fidelity', 'analytic', '--out', 'done')
KINDS = [
    *((VEHICLE, build) for build in TEXTS),
    *((('bag', 'info'), build) for build in REFUSED),
    *((CSV, build) for build in CSV_TEXTS),
    *((IMPORT, build) for build in LOGS),
    *((DRAFT, build) for build in DRAFTED),
    *((TUNNEL, build) for build in SHAPES),
]


def named(given):
    return given.__name__ if callable(given) else given[0]


@pytest.fixture
def attempt(sandbox, tmp_path):
    """Return what builds a file, runs a command on it and checks what holds for all of them."""

    def run(words, build):
        folder = tmp_path / 'work'
        folder.mkdir()
        path = build(folder)
        before = set(tmp_path.rglob('*'))
        told = sandbox.run([*words, path], folder)
        assert 'Traceback' not in told.err, told.err[-2000:]
        # 1: a recording with faults, or one of which nothing could be judged
        assert told.status in (0, 1, 2), (told.status, told.err[-500:])
        assert told.grown < MEMORY
        assert find_control(told.out + told.err) == set()
        left = set(tmp_path.rglob('*')) - before
        allowed = () if told.status else (folder / 'done',)
        assert all(any(place.is_relative_to(one) for one in allowed) for place in left), left
        return told

    return run


@pytest.mark.parametrize(('words', 'build'), KINDS, ids=named)
def test_what_cannot_be_used_is_one_sentence(attempt, words, build):
    told = attempt(words, build)
    assert told.status == 2, told.out
    lines = told.err.splitlines()
    assert len(lines) == 1, told.err
    assert lines[0].endswith('.')
    assert len(lines[0]) < 1000


@pytest.mark.parametrize('build', READ, ids=named)
def test_a_recording_is_read_as_far_as_it_goes(attempt, build):
    told = attempt(('bag', 'plot'), build)
    if told.status == 2:
        assert len(told.err.splitlines()) == 1
    else:
        assert told.err == ''


@pytest.mark.parametrize('verb', ['info', 'check', 'export'])
@pytest.mark.parametrize('name', ['names_that_climb', 'names_with_markup', 'attachment_outside'])
def test_names_lead_nowhere(attempt, verb, name):
    (build,) = [one for one in READ if one.__name__ == name]
    words = ('--out', 'done') if verb == 'export' else ()
    attempt(('bag', verb, *words), build)
