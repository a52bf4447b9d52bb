"""Define the results of a row that are stored between runs: values, pictures and tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import hashlib
import json
from typing import Any, final, NamedTuple

from lta_config.schema.paper_file import PaperRow
from lta_report.json_value import replace_nonfinite
from lta_report.report import TextTable
from lta_studies.reproduce.agreement import DrawSummary, summarize_draws
from lta_studies.reproduce.study_result import MeasuredValue, RowStudyResult


class StoredPicture(NamedTuple):
    """A stored picture; `figure` is Plotly's JSON."""

    name: str
    heading: str
    caption: str
    figure: str
    command: str
    bag: str


@final
@dataclass(frozen=True, slots=True)
class StoredRow:
    """
    Results of a row's study, its number of seeds and its duration. [s]

    `draws` has a summary for each claim and each of its measures that was drawn.
    """

    values: Mapping[str, MeasuredValue]
    pictures: Sequence[StoredPicture]
    tables: Sequence[TextTable]
    seeds: int
    seconds: float
    draws: Mapping[str, Mapping[str, DrawSummary]] = field(default_factory=dict)


def hash_row(row: PaperRow, seeds: int, quick: bool, code: str) -> str:
    """Return a hash of the inputs of a row: its file, the effort, and the hash of the code."""
    # Sorted keys, so that the order in the file does not matter.
    text = json.dumps([row.model_dump(mode='json'), seeds, quick, code], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def build_stored_row(
    row: PaperRow, result: RowStudyResult, seeds: int, seconds: float
) -> StoredRow:
    """Convert the result of a study to its stored form."""
    pictures = [
        StoredPicture(p.name, p.heading, p.caption, p.figure.to_json(), p.command, p.bag)
        for p in result.pictures
    ]
    draws = summarize_row_draws(row, result.draws)
    return StoredRow(result.values, pictures, result.tables, seeds, seconds, draws)


def summarize_row_draws(
    row: PaperRow, draws: Mapping[str, Sequence[float | str]]
) -> dict[str, dict[str, DrawSummary]]:
    """Summarize the draws of each claim, by measure."""
    summary = {
        name: {
            measure: summarize_draws(claim.rule, claim.value, draws[measure])
            for measure in claim.measures.values()
            if claim.rule is not None and draws.get(measure)
        }
        for name, claim in row.claims.items()
    }
    return {name: each for name, each in summary.items() if each}


def encode_values(values: Mapping[str, MeasuredValue]) -> dict[str, list[Any]]:
    """Convert values to JSON, with NaN as null."""
    encoded: dict[str, list[Any]] = replace_nonfinite(values)
    return encoded
