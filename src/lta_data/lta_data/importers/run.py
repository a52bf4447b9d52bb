# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Import logs as bags, all of them or none."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
import time
from typing import Final, final

from lta_bag.bag_folder import find_bag
from lta_bag.storage import StorageFault
from lta_bag.writer import prepare_empty_folder
from lta_config.atomic_file import stage_results
from lta_config.errors import BadInput, to_one_line
from lta_config.schema.import_file import load_mapping
from lta_data.importers.formats import detect_format, find_format
from lta_data.importers.log_clocks import Clocks, estimate_clocks, set_clocks, share_clocks
from lta_data.importers.log_provenance import build_provenance
from lta_data.importers.log_to_bag import write_log_bag
from lta_data.importers.mapping_choice import (
    choose_entries,
    describe_unknown_actuators,
    select_mapping,
)
from lta_data.importers.protocol import Reached
from lta_data.importers.readers.sensor_folder import (
    describe_empty_files,
    list_data_files,
    list_run_files,
    list_run_folders,
    name_table,
)

Progress = Callable[[str, float], object]  # name of the log that is read, and logs done

UPDATE_PERIOD: Final = 0.1  # s of wall time between two reports of the progress within a log
BAG_FOLDER: Final = 'bag'  # as in a flight's results folder


@final
@dataclass(frozen=True, slots=True)
class ImportRequest:
    """Logs to import, how to read them, and the target robot."""

    sources: Sequence[Path]
    mapping: str | None = None
    format: str | None = None
    robot: str = 'lta1'
    vehicle: str | None = None


@final
@dataclass(slots=True)
class ImportedLog:
    """One imported log."""

    # The log and the new bag
    source: str
    bag: str
    # How it was read; '' without a mapping
    format: str
    mapping: str
    data: str  # 'measured' or 'simulated', as the mapping declares; '' without one
    topics: dict[str, int] = field(default_factory=dict)  # messages by topic
    # Remarks on odd, missing or omitted data, one sentence each
    notes: list[str] = field(default_factory=list)


def import_logs(
    order: ImportRequest, out: Path, progress: Progress = lambda name, done: None
) -> list[ImportedLog]:
    """
    Import logs to a folder: `out/bag` for one, `out/NAME/bag` for each of several.

    Raise `BadInput` if one of them cannot be imported; then no bag is written.
    """
    done: list[ImportedLog] = []
    sources = [one for source in order.sources for one in expand_source(source, order.mapping)]
    # Refuse before any work, rather than after a long import.
    if out.exists():
        prepare_empty_folder(out)
    clocks = share_clocks([_estimate_clocks(order, source) for source in sources])
    # Written beside the target and moved at the end: all logs or none
    with stage_results(out, BAG_FOLDER) as folder:
        for source, name, times in zip(sources, _name_folders(sources), clocks, strict=True):
            inside = Path(name) / BAG_FOLDER if len(sources) > 1 else Path(BAG_FOLDER)
            imported = _import_log(
                order, source, times, len(sources) == 1, folder / inside,
                report_parts(progress, source.name, len(done)),
            )  # fmt: skip
            imported.bag = str(out / inside)
            done.append(imported)
    done[0].notes += [note for one in order.sources for note in describe_empty_files(one)]
    return done


def report_parts(progress: Progress, name: str, before: int) -> Reached:
    """Return what reports the fraction of a log that has been read; `before`: logs done."""
    progress(name, float(before))
    reported_at = time.monotonic()

    def report(part: float) -> None:
        nonlocal reported_at
        now = time.monotonic()
        if now - reported_at >= UPDATE_PERIOD:
            reported_at = now
            progress(name, before + part)

    return report


def expand_source(source: Path, mapping: str | None) -> list[Path]:
    """
    Return the logs of a source: the files of a folder with one run in each, else itself.

    A folder is one log if it is a bag, or if the mapping is for the format folder and it does not
    hold a folder with the same tables for each run.

    Raise `BadInput` if a folder contains no log.
    """
    log = find_bag(source)
    if not log.is_dir() or detect_format(log) == 'bag':
        return [log]
    if mapping is not None and (loaded := load_mapping(mapping)[0]).format == 'folder':
        runs = list_run_folders(source)
        inside = (
            {name_table(runs[0], file) for file in list_data_files(runs[0])} if runs else set()
        )
        # The folders of a source may also be parts of one run, which its mapping then names
        fits = {one.table.partition('.')[0] for one in loaded.topics if one.table} <= inside
        return runs if runs and fits else [source]
    return list_run_files(source)


def _name_folders(sources: Sequence[Path]) -> list[str]:
    """Return a unique folder name for each source: its name without suffixes."""
    names: list[str] = []
    for source in sources:
        # The part before the first dot: 'flight.csv.gz' becomes 'flight'
        stem = source.name.split('.')[0] or 'log'
        count = sum(name == stem or name.startswith(f'{stem}-') for name in names)
        names.append(f'{stem}-{count + 1}' if stem in names else stem)
    return names


def _estimate_clocks(order: ImportRequest, source: Path) -> Clocks:
    """Return the clocks of the tables of a log that its mapping wants to be aligned."""
    format_ = detect_format(source) if order.format is None else order.format
    find_format(format_)
    mapping, _ = select_mapping(source, format_, order.mapping)
    return {} if mapping is None else estimate_clocks(source, mapping, order.robot)


def _import_log(
    order: ImportRequest, source: Path, times: Clocks, alone: bool, bag: Path, reached: Reached
) -> ImportedLog:
    format_ = detect_format(source) if order.format is None else order.format
    # Raises for an unknown --format, before any mapping is loaded
    find_format(format_)
    mapping, text = select_mapping(source, format_, order.mapping)
    provenance = build_provenance(source, format_, mapping, text, order.vehicle)
    clocks: list[str] = []
    if mapping is not None:
        mapping, clocks = set_clocks(mapping, times, alone)
    try:
        log = find_format(format_).opened(source, mapping)
        chosen = choose_entries(source, mapping, log, order.robot)
        imported = ImportedLog(
            str(source),
            str(bag),
            format_,
            mapping.name if mapping else '',
            mapping.data if mapping else '',
        )
        strange = (
            [] if order.vehicle is None else describe_unknown_actuators(order.vehicle, chosen)
        )
        imported.topics, imported.notes = write_log_bag(log, chosen, bag, provenance, reached)
        imported.notes = [to_one_line(note) for note in [*imported.notes, *clocks, *strange]]
    except (OSError, StorageFault) as fault:
        reason = str(fault).rstrip('.')
        raise BadInput(f"'{source}' cannot be imported: {reason}.") from None
    return imported
