"""Define the results of a row that are stored between runs: values, pictures and tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import hashlib
import json
import math
from typing import Any, final, NamedTuple

from lta_config.schema.paper_file import PaperRow
from lta_report.json_value import replace_nonfinite
from lta_report.report import TextTable
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
    """Results of a row's study, its number of seeds and its duration. [s]"""

    values: Mapping[str, MeasuredValue]
    pictures: Sequence[StoredPicture]
    tables: Sequence[TextTable]
    seeds: int
    seconds: float


def hash_row(row: PaperRow, seeds: int, quick: bool, code: str) -> str:
    """Return a hash of the inputs of a row: its file, the effort, and the hash of the code."""
    # Sorted keys, so that the order in the file does not matter.
    text = json.dumps([row.model_dump(mode='json'), seeds, quick, code], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def build_stored_row(result: RowStudyResult, seeds: int, seconds: float) -> StoredRow:
    """Convert the result of a study to its stored form."""
    pictures = [
        StoredPicture(p.name, p.heading, p.caption, p.figure.to_json(), p.command, p.bag)
        for p in result.pictures
    ]
    return StoredRow(result.values, pictures, result.tables, seeds, seconds)


def encode_values(values: Mapping[str, MeasuredValue]) -> dict[str, list[Any]]:
    """Convert values to JSON, with NaN as null."""
    known: dict[str, list[Any]] = replace_nonfinite(values)
    return known


def decode_values(content: Mapping[str, Sequence[Any]]) -> dict[str, MeasuredValue]:
    """Convert JSON to values."""
    return {name: decode_value(each) for name, each in content.items()}


def decode_value(content: Sequence[Any]) -> MeasuredValue:
    """Convert a JSON list to a value, with null as NaN."""
    # Order of the fields: value, low, high, seeds
    value, low, high = (math.nan if each is None else each for each in content[:3])
    return MeasuredValue(value, low, high, content[3])
