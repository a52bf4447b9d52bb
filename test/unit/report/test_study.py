# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A study resumes from its store, and its results do not depend on the order of its workers."""

from dataclasses import dataclass, replace
import io
import json
import math
import sys
from typing import NamedTuple

from lta_config.errors import BadInput
from lta_report.study import Study, StudyOptions
from lta_report.study_store import StoreFormat, StudyStore
from lta_report.workers import ItemFailure
from pydantic import TypeAdapter
import pytest
from rich.console import Console
import worker_functions

NUMBERS = StoreFormat('numbers.jsonl', 'count', 'count', TypeAdapter(int))
QUIET = Console(file=io.StringIO())


def count(folder, function, items, identity='mine', **options):
    return Study(function, str, NUMBERS, 'numbers').run(
        items, folder, identity, StudyOptions(**options), QUIET
    )


def test_results_come_in_the_order_of_the_items(tmp_path):
    outcome = count(tmp_path, worker_functions.square_late, [0, 3, 1, 2], workers=2)
    assert list(outcome.results.items()) == [('0', 0), ('3', 9), ('1', 1), ('2', 4)]
    assert (outcome.finished, outcome.lost, outcome.failures) == (4, 0, {})


def test_what_is_stored_is_not_computed_again(tmp_path):
    count(tmp_path, worker_functions.fail_at_odd, [0, 2], workers=1)
    again = count(tmp_path, worker_functions.fail_at_odd, [0, 2, 4], workers=1)
    assert (again.finished, again.require_all()) == (1, [0, 4, 16])


def test_ctrl_c_loses_only_what_is_running(tmp_path):
    def interrupt(item):
        if item == 2:
            raise KeyboardInterrupt
        return item

    with pytest.raises(KeyboardInterrupt):
        count(tmp_path.with_name('other'), interrupt, [2], workers=1)  # nothing is finished
    stopped = count(tmp_path, interrupt, [0, 1, 2, 3], workers=1)
    assert (stopped.finished, stopped.results) == (2, {'0': 0, '1': 1})
    with pytest.raises(KeyboardInterrupt):
        stopped.require_all()
    again = count(tmp_path, abs, [0, 1, 2, 3], workers=1)
    assert (again.finished, again.require_all()) == (2, [0, 1, 2, 3])


def test_failures_are_stored_with_their_reason_until_they_are_repeated(tmp_path):
    for _ in range(2):
        outcome = count(tmp_path, worker_functions.fail_at_odd, [2, 3], workers=1)
        with pytest.raises(
            BadInput, match=r'^1 of 2 numbers failed\. 3: 3 is not even\. .*--retry-failed'
        ):
            outcome.require_all()
    assert outcome.finished == 0
    again = count(tmp_path, abs, [2, 3], workers=1, retry_failed=True)
    assert (again.finished, again.require_all()) == (1, [4, 3])
    assert count(tmp_path, abs, [2, 3], workers=1).require_all() == [4, 3]


def test_a_later_line_replaces_an_earlier_one(tmp_path):
    for outcome in (1, ItemFailure('No.'), 2):
        with StudyStore(tmp_path, NUMBERS, 'mine') as store:
            store.add('a', outcome)
    with StudyStore(tmp_path, NUMBERS, 'mine') as store:
        assert (store.results, store.failures) == ({'a': 2}, {})
    assert [*map(json.loads, (tmp_path / 'numbers.jsonl').read_text().splitlines())] == [
        {'count': 'mine'},
        {'key': 'a', 'result': 1},
        {'key': 'a', 'failed': 'No.'},
        {'key': 'a', 'result': 2},
    ]


def test_a_cluster_that_is_not_there_leaves_no_folder(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, 'distributed', None)
    with pytest.raises(BadInput, match='-r requirements-dask'):
        count(tmp_path / 'out', abs, [1], scheduler='tcp://127.0.0.1:1')
    assert not (tmp_path / 'out').exists()


def test_items_that_cannot_be_run_are_refused_before_the_first(tmp_path):
    def refuse(todo):
        raise BadInput(f'{todo} cannot be run.')

    count(tmp_path, abs, [1], workers=1)
    with pytest.raises(BadInput, match=r'^\[2\] cannot be run'):
        Study(abs, str, NUMBERS, 'numbers').run(
            [1, 2], tmp_path, 'mine', StudyOptions(workers=1), QUIET, refuse
        )


class Spread(NamedTuple):
    """A number or a word with a bound."""

    value: float | str
    high: float = math.nan


@dataclass(frozen=True, slots=True)
class Table:
    """Nested values, as studies return them."""

    rows: tuple[Spread, ...]
    values: dict[str, Spread]


def test_nan_and_infinity_survive_the_store(tmp_path):
    form = replace(NUMBERS, adapter=TypeAdapter(Table))
    table = Table((Spread('yes'), Spread(math.nan, math.inf)), {'x': Spread(1 / 3, -math.inf)})
    with StudyStore(tmp_path, form, 'mine') as store:
        store.add('a', table)
    with StudyStore(tmp_path, form, 'mine') as store:
        stored = store.results['a']
    assert repr(stored) == repr(table)
    assert isinstance(stored.rows[1], Spread)
