# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Each fault and its end get a line, whatever the node does; one that flaps is counted."""

from lta_graph.health import (
    Health,
    HealthFact,
    HealthLevel,
    HealthLog,
    LINES_PER_STATUS,
    LOG_WINDOW,
    MAX_STATUSES,
)
import pytest

OK, WARN, ERROR = HealthLevel.OK, HealthLevel.WARN, HealthLevel.ERROR


def lines(log, now, *facts):
    """Return the lines for facts of one task, each a level and a message."""
    return log.update([HealthFact('link', *fact) for fact in facts], now)


def test_what_was_never_wrong_gets_no_line():
    log = HealthLog()
    assert lines(log, 0.0, (OK, 'connected'), (OK, 'still connected')) == []


@pytest.mark.parametrize('level', [WARN, ERROR, HealthLevel.STALE])
def test_a_fault_gets_one_line_and_its_end_another(level):
    log = HealthLog()
    assert lines(log, 0.0, (level, 'silent for 0.5 s')) == [(level, 'link: silent for 0.5 s')]
    for k in range(100):  # the same with other numbers, however long
        assert lines(log, 1.0 + k, (level, f'silent for {k + 1} s')) == []
    assert lines(log, 200.0, (OK, 'connected')) == [(OK, 'link: OK again, connected')]
    assert lines(log, 201.0, (OK, 'connected')) == []


def test_another_fault_of_the_same_task_gets_its_line_at_once():
    log = HealthLog()
    messages = [(WARN, 'holding'), (WARN, 'landing'), (ERROR, 'landing'), (ERROR, 'stopped')]
    assert lines(log, 0.0, *messages) == [(level, f'link: {text}') for level, text in messages]


def test_a_fault_between_two_reports_is_not_missed():
    """/diagnostics has only the newest status of a task."""
    health, log = Health(), HealthLog()
    health.report('link', ERROR, 'lost')
    health.report('link', OK, 'connected')
    heard = log.update(health.take_news(), 0.0)
    assert heard == [(ERROR, 'link: lost'), (OK, 'link: OK again, connected')]
    for fault in ('holding for 3 s', 'holding for 4 s', 'landing'):  # of one level
        health.report('link', WARN, fault)
    health.report('link', OK, 'connected')
    heard = log.update(health.take_news(), 0.05)
    assert [line.text for line in heard] == [
        'link: holding for 3 s', 'link: landing', 'link: OK again, connected',
    ]  # fmt: skip
    assert log.update(health.take_news(), 0.1) == []


def test_a_fault_that_flaps_is_counted_and_hides_no_other():
    log, heard = HealthLog(), []
    for k in range(100):  # ten times a second for ten seconds
        heard += lines(log, 0.1 * k, (OK, 'connected') if k % 2 else (WARN, 'weak'))
    assert len(heard) == 4
    assert lines(log, 9.95, (ERROR, 'lost')) == [(ERROR, 'link: lost')]
    assert lines(log, LOG_WINDOW + 0.1, (OK, 'connected')) == [
        (OK, 'link: OK again, connected (changed 96 more times in 10 s)')
    ]
    later = [
        line
        for k in range(600)  # for a minute more
        for line in lines(log, 11.0 + 0.1 * k, (OK, 'connected') if k % 2 else (WARN, 'weak'))
    ]
    assert len(later) <= 6
    assert lines(log, 90.0, (WARN, 'weak')) != []


def test_messages_that_quote_others_cannot_fill_the_log():
    log = HealthLog()
    heard = [
        line
        for k in range(1000)
        for line in lines(log, 0.001 * k, (WARN, 'of ' + 'x' * (k % 500)), (OK, 'fine'))
    ]
    assert len(heard) <= MAX_STATUSES * LINES_PER_STATUS
    (line,) = lines(HealthLog(), 0.0, (WARN, 'red\x1b[31m'))
    assert line.text.isprintable()
