# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Run a study: one function on many items, in parallel, with resume and progress.

A study declares its items, a function at the top of a module, and the format of its store. Items
that failed count as done until the study is repeated with --retry-failed.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
import hashlib
from pathlib import Path
import time
from typing import Final, final, Generic, TypeVar

from lta_config.errors import BadInput
from lta_report.progress_bar import ProgressBar
from lta_report.study_store import StoreFormat, StudyStore
from lta_report.workers import ItemFailure, open_workers, Workers
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

BAR_PERIOD: Final = 0.1  # wall s between two updates of the bar
RECENT: Final = 60.0  # s over which the rate is averaged


@final
class StudyProgress(ProgressBar):
    """
    Show the progress of a study.

    `console`: output; nothing is shown if it is not a terminal. `total`, `done`: number of items,
    and of those already finished. `unit`: what the items are, such as 'flights'.
    """

    def __init__(self, console: Console, total: int, done: int = 0, unit: str = 'items') -> None:
        super().__init__(
            console,
            TextColumn('{task.description}'),
            BarColumn(),
            MofNCompleteColumn(),
            # The first item may take minutes, in which only these two tell that it goes on
            TextColumn('{task.percentage:.0f} % after'),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            TextColumn('left'),
            TextColumn('{task.fields[rate]}'),
            TextColumn('{task.fields[detail]}'),
            begin=unit,
            total=total,
            completed=done,
            period=RECENT,
            rate='',
            detail='',
        )
        self._unit, self._done, self._part, self._lost = unit, done, 0.0, 0
        self._counts: Counter[str] = Counter()
        self._detail = ''
        self._shown_at = -BAR_PERIOD  # in the past, so that the first item is shown at once

    def __exit__(self, *_: object) -> None:
        """Update the bar a last time and remove it."""
        self._update()
        super().__exit__()

    def skip_items(self, count: int) -> None:
        """Count items as finished before the work begins."""
        self._done += count
        self.update_bar(completed=self._done)

    def count_item(self, word: str = '', lost: int = 0) -> None:
        """Count an item under a word; `lost` is the number of workers that died so far."""
        self._done += 1
        self._part = 0.0
        self._lost = lost
        if word:
            self._counts[word] += 1
        self._update_sometimes()

    def show_detail(self, words: str) -> None:
        """Show words after the counts."""
        self._detail = words
        self._update_sometimes()

    def show_part(self, part: float) -> None:
        """Show the finished share of the current items, added up."""
        self._part = part
        self._update_sometimes()

    def _update_sometimes(self) -> None:
        # A batch finishes thousands of items at once
        if time.monotonic() - self._shown_at >= BAR_PERIOD:
            self._update()

    def _update(self) -> None:
        self._shown_at = time.monotonic()
        words = [f'{count} {word}' for word, count in sorted(self._counts.items())]
        if self._lost:
            words.append(f'{self._lost} workers lost')
        if self._detail:
            words.append(self._detail)
        self.update_bar(completed=self._done + self._part, detail=', '.join(words))
        if self.speed and self.speed >= 0.1:
            self.update_bar(rate=f'{self.speed:.1f} {self._unit}/s')


Item = TypeVar('Item')
Result = TypeVar('Result')


def hash_inputs(*parts: object) -> str:
    """Return a hash of the text of everything that determines the results of a study."""
    return hashlib.sha256('\n'.join(map(str, parts)).encode()).hexdigest()


@final
@dataclass(frozen=True, slots=True)
class StudyOptions:
    """The options --workers, --scheduler and --retry-failed of a study."""

    workers: int | None = None
    scheduler: str | None = None
    retry_failed: bool = False

    def open_workers(
        self,
        function: Callable[[Item], Result],
        on_progress: Callable[[float], None] | None = None,
    ) -> Workers[Item, Result]:
        """Return the workers that apply a function; they start as a context manager."""
        return open_workers(function, self.workers, self.scheduler, on_progress)


@final
@dataclass(frozen=True, slots=True)
class StudyOutcome(Generic[Result]):
    """The outcome of a study."""

    # Results by key, in the order of the items; failed items are missing
    results: Mapping[str, Result]
    failures: Mapping[str, ItemFailure]  # failed items by key
    # Items of this run, and workers that died in it
    finished: int
    lost: int
    unit: str  # what the items are, such as 'flights'
    folder: Path  # folder of the store
    stopped: bool = False  # whether Ctrl-C ended this run early

    def require_all(self) -> list[Result]:
        """Return all results; raise `BadInput` if an item failed, KeyboardInterrupt if stopped."""
        if self.stopped:
            raise KeyboardInterrupt
        if self.failures:
            key, failure = next(iter(self.failures.items()))
            raise BadInput(
                f'{len(self.failures)} of {len(self.results) + len(self.failures)} {self.unit} '
                f"failed. {key}: {failure.reason} The others are stored in '{self.folder}'; run "
                'the command again with --retry-failed to repeat the failed ones there.'
            )
        return list(self.results.values())


def run_items(
    items: Iterable[Item],
    workers: Workers[Item, Result],
    save: Callable[[Item, Result | ItemFailure], str],
    progress: StudyProgress,
) -> None:
    """
    Run items and save each outcome at once, so that Ctrl-C loses only what is running.

    Parameters
    ----------
    workers : Workers
        Not started yet.
    save : callable
        Stores an outcome and returns the word under which the progress bar counts it, or ''.

    """
    with progress, workers:
        for item, outcome in workers.run(items):
            progress.count_item(save(item, outcome), workers.lost)


@final
@dataclass(frozen=True, slots=True)
class Study(Generic[Item, Result]):
    """What a study consists of."""

    function: Callable[[Item], Result]  # returns the result of an item; must be picklable
    find_key: Callable[[Item], str]  # returns the key of an item in the store
    form: StoreFormat[Result]  # how results are stored
    unit: str  # what the items are, such as 'flights'
    # Returns a line that a terminal shows when an item is finished
    describe: Callable[[Item, Result], str] | None = None

    def run(
        self,
        items: Sequence[Item],
        folder: Path,
        identity: str,
        options: StudyOptions,
        console: Console,
        check: Callable[[Sequence[Item]], None] = lambda _: None,
    ) -> StudyOutcome[Result]:
        """
        Run the items that are not stored yet, and return the outcome of all.

        After Ctrl-C, return the outcome of the finished items.

        Parameters
        ----------
        items : sequence
            All items of the study.
        folder : Path
            Folder of the store.
        identity : str
            Hash of everything that determines the results, except what the keys tell.
        options : StudyOptions
            Workers or scheduler, and whether to repeat failed items.
        check : callable
            Raises `BadInput` if items that are not stored cannot be run.

        Raises
        ------
        BadInput
            If the folder belongs to something else, or the workers cannot start.
        KeyboardInterrupt
            After Ctrl-C before anything is finished.

        """
        progress = StudyProgress(console, len(items), unit=self.unit)
        # Before the folder is created: the scheduler may not answer
        workers = options.open_workers(self.function, progress.show_part)
        keys = [self.find_key(item) for item in items]
        with StudyStore(folder, self.form, identity, options.retry_failed) as store:
            todo = [item for item, key in zip(items, keys, strict=True) if key not in store]
            check(todo)
            progress.skip_items(len(items) - len(todo))

            def save(item: Item, outcome: Result | ItemFailure) -> str:
                store.add(self.find_key(item), outcome)
                if isinstance(outcome, ItemFailure):
                    return 'failed'
                # In a log file, the bar itself prints lines
                if self.describe is not None and console.is_terminal:
                    progress.show_message(self.describe(item, outcome))
                return ''

            stopped = False
            try:
                run_items(todo, workers, save, progress)
            except KeyboardInterrupt:
                if not store.results:
                    raise
                stopped = True
        return StudyOutcome(
            {key: store.results[key] for key in keys if key in store.results},
            {key: store.failures[key] for key in keys if key in store.failures},
            sum(self.find_key(item) in store for item in todo),
            workers.lost,
            self.unit,
            folder,
            stopped,
        )
