"""
Run a study: one function on many items, in parallel, with resume and progress.

A study declares its items, a function at the top of a module, and the format of its store. Items
that failed count as done until the study is repeated with --retry-failed.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final, Generic, TypeVar

from lta_config.errors import BadInput
from lta_report.study_progress import StudyProgress
from lta_report.study_store import StoreFormat, StudyStore
from lta_report.workers import ItemFailure, open_workers, Workers
from rich.console import Console

Item = TypeVar('Item')
Result = TypeVar('Result')


@final
@dataclass(frozen=True, slots=True)
class StudyOptions:
    """The options --workers, --scheduler and --retry-failed of a study."""

    workers: int | None = None
    scheduler: str | None = None
    retry_failed: bool = False


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

    def require_all(self) -> list[Result]:
        """Return all results; raise `BadInput` if an item failed."""
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
) -> int:
    """
    Run items and save each outcome at once, so that Ctrl-C loses only what is running.

    Parameters
    ----------
    workers : Workers
        Not started yet.
    save : callable
        Stores an outcome and returns the word under which the progress bar counts it, or ''.

    Returns
    -------
    int
        Number of items.

    """
    count = 0
    with progress, workers:
        for item, outcome in workers.run(items):
            progress.count_item(save(item, outcome), workers.lost)
            count += 1
    return count


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

        """
        progress = StudyProgress(console, len(items), unit=self.unit)
        # Before the folder is created: the scheduler may not answer
        workers = open_workers(
            self.function, options.workers, options.scheduler, progress.show_part
        )
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

            finished = run_items(todo, workers, save, progress)
        return StudyOutcome(
            {key: store.results[key] for key in keys if key in store.results},
            {key: store.failures[key] for key in keys if key in store.failures},
            finished,
            workers.lost,
            self.unit,
            folder,
        )
