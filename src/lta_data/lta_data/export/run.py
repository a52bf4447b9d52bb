"""One recording into files of one format, a file a topic or one for all on one clock."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
import re
from typing import Final, final, Protocol

from lta_bridge.bag.writer import empty_folder
from lta_config.errors import BadInput, unknown
from lta_config.whole_file import whole
from lta_data.bag.recording import IMAGE, Recording
from lta_data.export.csv_file import write_csv, write_units
from lta_data.export.mat_file import write_mat
from lta_data.export.parquet_file import write_parquet
from lta_data.export.source import Source, source_of, source_of_table

FORMATS: Final[dict[str, Callable[[Source, Path], Iterator[int]]]] = {
    'parquet': write_parquet,
    'csv': write_csv,
    'mat': write_mat,
}
ALIGNED: Final = 'aligned'


class Watcher(Protocol):
    """Whoever looks on."""

    def at(self, topic: str, done: int, total: int) -> None:
        """Tell which topic is written, and how many are done."""
        ...


@final
@dataclass(frozen=True, slots=True)
class Order:
    """
    What to export.

    Attributes
    ----------
    form : str
        One of `FORMATS`.
    topics : tuple of str
        Names; all if empty.
    rate : float or None
        Of one clock for all in one file; None for a file a topic. [Hz]
    method : str
        How columns get values on that clock; see `lta_data.bag.align`.

    """

    form: str
    topics: tuple[str, ...] = ()
    rate: float | None = None
    method: str = 'previous'


@final
@dataclass(frozen=True, slots=True)
class Exported:
    """One file: topic, place, and size of its table."""

    topic: str
    file: Path
    rows: int
    columns: int


@final
@dataclass(frozen=True, slots=True)
class Done:
    """The files, and a sentence for all that is left out."""

    files: list[Exported]
    remarks: list[str]


def export(recording: Recording, order: Order, folder: Path, watcher: Watcher) -> Done:
    """
    Write a recording into a folder.

    Raises
    ------
    BadInput
        If the format or a named topic is unknown, the topic cannot be decoded, the folder is not
        empty, or the disk cannot take the files.

    """
    if order.form not in FORMATS:
        raise unknown('format', order.form, list(FORMATS))
    topics = chosen(recording, order.topics)
    done, written = Done([], []), []
    try:
        if order.rate is not None:
            tables = together(recording, topics, order, done)
            empty_folder(folder)
            watcher.at(ALIGNED, 0, 1)
            written.append(save(tables, folder, order.form, done))
        else:
            empty_folder(folder)
            for index, topic in enumerate(topics):
                watcher.at(topic, index, len(topics))
                try:
                    source = source_of(recording.flight, topic)
                except BadInput as fault:
                    if order.topics:
                        raise
                    done.remarks.append(f"Topic '{topic}' is left out: {fault}")
                    continue
                written.append(save(source, folder, order.form, done))
        if order.form == 'csv':
            write_units(written, folder)
        done.remarks.extend(recording.losses)  # some damage shows only where it is read
    except OSError as error:
        raise BadInput(
            f"The files cannot be written to '{folder}' ({error.strerror or error}); make room, "
            'or choose another folder with --out.'
        ) from error
    return done


def chosen(recording: Recording, topics: Sequence[str]) -> list[str]:
    """Return the topics to write: those that are named, or the robot's and those of no robot."""
    for topic in topics:
        recording.flight.type_of(topic)
    if topics:
        return list(dict.fromkeys(topics))
    shared = [name for name in recording.flight.bag.topics if name.count('/') == 1]
    return recording.topics + (shared if recording.robot else [])


def together(recording: Recording, topics: Sequence[str], order: Order, done: Done) -> Source:
    """Return all topics on one clock; images and what cannot be decoded are left out."""
    usable = []
    for topic in topics:
        try:
            if recording.flight.type_of(topic) == IMAGE:
                raise BadInput('samples have a clock of their own; export it without --rate.')
            recording[topic]
        except BadInput as fault:
            if order.topics:
                raise BadInput(f"Topic '{topic}' cannot be aligned: {fault}") from fault
            done.remarks.append(f"Topic '{topic}' is left out: {fault}")
            continue
        usable.append(topic)
    table = recording.aligned(*usable, rate=order.rate, method=order.method)
    return source_of_table(table, ALIGNED)


def save(source: Source, folder: Path, form: str, done: Done) -> tuple[str, Source]:
    """Write one file, whole or not at all."""
    name = re.sub(r'\W+', '_', source.name).strip('_') or 'topic'
    taken = {exported.file.stem for exported in done.files}
    while name in taken:
        name += '_'
    path = folder / f'{name}.{form}'
    with whole(path) as part:
        rows = sum(FORMATS[form](source, part))
    done.files.append(Exported(source.name, path, rows, len(source.declared)))
    if source.remark:
        done.remarks.append(source.remark)
    return path.name, source
