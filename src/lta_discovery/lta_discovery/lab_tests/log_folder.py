# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find the logs in a folder of tests, and import those that are no bags."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final, final, NamedTuple

from lta_bag.bag_folder import find_bag
from lta_config.errors import BadInput
from lta_config.schema.import_file import load_mapping
from lta_data.importers.draft.choices import DraftQuestion, DraftVehicle
from lta_data.importers.draft.draft_mapping import (
    COLUMN_FORMATS,
    count_changing_columns,
    draft_mapping,
    MappingDraft,
    measure_size,
    read_source,
)
from lta_data.importers.formats import detect_format, LOG_FORMATS
from lta_data.importers.readers.sensor_folder import describe_empty_files, list_run_files
from lta_data.importers.run import import_logs, ImportRequest

MAPPING: Final = 'mapping.yaml'  # in the folder: for all its logs
MCAP: Final = '.mcap'
OWN_TOPIC_ENDS: Final = ('/ground_truth/odom', '/motors', '/wrench_command')  # ends of topics


@final
class LabLogs(NamedTuple):
    """The logs of a folder."""

    bags: list[Path]
    drafts: dict[str, str]  # drafted mappings by the name of a file
    notes: list[str]  # on files that were left out, one sentence each


def open_lab_folder(
    folder: Path,
    mapping: str | None,
    answers: Mapping[str, str],
    vehicle: str,
    scratch: Path,
    tell: Callable[[str], None],
) -> LabLogs:
    """
    Return the bags of a folder; other logs are imported to a scratch folder.

    The mapping of a log is the given one, NAME.yaml beside it, or mapping.yaml in the folder.
    Without any of them it is drafted, once for all logs with the same columns.

    `answers`: decisions for drafts, by key. `vehicle`: name or file of the one that flew. Raise
    `BadInput` if there is no log, or one cannot be imported.
    """
    if not folder.is_dir():
        raise BadInput(f"'{folder}' is not a folder; name the folder that holds the logs.")
    logs = list(_list_logs(folder))
    if not logs:
        raise BadInput(
            f"'{folder}' holds no bag and no log file; put the logs of the tests there."
        )
    mappings = {log: _find_mapping(log, folder, mapping) for log in logs}
    draft_vehicle = DraftVehicle.load(vehicle)
    drafts = _draft_mappings([log for log in logs if mappings[log] == ''], answers, draft_vehicle)
    written: dict[str, str] = {}
    for log, text in drafts.items():
        if text not in written.values():
            written['mapping.yaml' if not written else f'mapping_{len(written) + 1}.yaml'] = text
        name = next(each for each, other in written.items() if other == text)
        (scratch / name).write_text(text, encoding='utf-8')
        mappings[log] = str(scratch / name)
    bags = [_open_log(log, mappings[log], scratch, tell) for log in logs]
    return LabLogs(bags, written, describe_empty_files(folder))


def _list_logs(folder: Path) -> Iterator[Path]:
    """Yield the logs directly in a folder: files, bags, and folders with a file per sensor."""
    files = {*list_run_files(folder)}
    for path in sorted(folder.iterdir()):
        if path in files or (path.is_dir() and path.name[0] != '.' and _holds_log(path)):
            yield path


def _holds_log(path: Path) -> bool:
    """Return whether a folder is one log: a bag, or a file for each sensor; not several runs."""
    try:
        return detect_format(find_bag(path)) == 'bag' or read_source(path).format == 'folder'
    except BadInput:
        return False


def _find_mapping(log: Path, folder: Path, requested: str | None) -> str | None:
    """Return the mapping of a log; '' if it has to be drafted, None if it needs none."""
    beside = folder / f'{_log_name(log)}.yaml'
    for path in (beside, folder / MAPPING):
        if requested is None and path.is_file():
            requested = str(path)
    format_ = detect_format(find_bag(log))
    if format_ in COLUMN_FORMATS:
        return requested or ''
    if format_ == 'bag' and requested is None and not _has_our_topics(find_bag(log)):
        return ''
    # Bags of ours need no mapping; other formats have a shipped one
    fits = requested is not None and load_mapping(requested)[0].format == format_
    return requested if fits else LOG_FORMATS[format_].mapping


def _has_our_topics(bag: Path) -> bool:
    """Return whether a bag has a pose or commands on topics with the names of LTA."""
    names = LOG_FORMATS['bag'].opened(bag, None).raw
    return any(f'/{name.lstrip("/")}'.endswith(OWN_TOPIC_ENDS) for name in names)


def _log_name(log: Path) -> str:
    """Return the name of a log without its suffix; it may contain dots, as dates do."""
    return log.name if log.is_dir() else log.name.removesuffix('.gz').rpartition('.')[0]


def _draft_mappings(
    logs: Sequence[Path], answers: Mapping[str, str], vehicle: DraftVehicle
) -> dict[Path, str]:
    """Return a drafted mapping for each log, from the one of its columns that decides most."""
    alike: dict[tuple[object, ...], dict[Path, tuple[int, int]]] = {}
    for log in logs:
        source = read_source(log)
        columns = tuple((name, *table) for name, table in source.tables.items())
        # A float alone cannot tell up from down, nor how motors rest
        says = (count_changing_columns(source), measure_size(log))
        alike.setdefault((source.format, columns), {})[log] = says
    out = {}
    for group in alike.values():
        same = sorted(group, key=lambda log: group[log], reverse=True)
        text = _draft_first(same, answers, vehicle)
        out.update(dict.fromkeys(same, text))
    return out


def _draft_first(logs: Sequence[Path], answers: Mapping[str, str], vehicle: DraftVehicle) -> str:
    """
    Return the first draft without an open question; raise `BadInput` with one otherwise.

    A log in which nothing is commanded has fewer topics, and answers no question about commands.
    """
    first = draft_mapping(logs[0], answers, vehicle)
    if not first.choices.questions:
        return first.text
    for log in logs[1:]:
        draft = draft_mapping(log, answers, vehicle)
        if not draft.choices.questions and count_topics(draft) >= count_topics(first):
            return draft.text
    raise BadInput(_format_question(logs[0], first.choices.questions[0]))


def count_topics(draft: MappingDraft) -> int:
    """Return the number of topics that a draft fills."""
    return draft.text.count('- topic:')


def _format_question(log: Path, question: DraftQuestion) -> str:
    """Return an open question with the options that decide it."""
    choices = ' or '.join(
        f'--set {question.key}={name} ({meaning})' for name, meaning in question.options
    )
    return f"'{log.name}': {question.reason} Decide with {choices}."


def _open_log(log: Path, mapping: str | None, scratch: Path, tell: Callable[[str], None]) -> Path:
    """Return a bag as it is, or the bag of an imported log."""
    bag = find_bag(log)
    if mapping is None and (bag.is_dir() or bag.suffix == MCAP):
        return log
    tell(f'importing {log.name}')
    out = scratch / _log_name(log)
    if out.exists():
        # The same name with another suffix
        out = scratch / log.name
    import_logs(ImportRequest([log], mapping), out)
    return out
