"""A row as it is kept between runs: JSON with values, pictures and tables."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
import hashlib
import json
import math
from pathlib import Path
from typing import Any, final, NamedTuple

from lta_config.schema.paper_file import PaperRow
from lta_report.json_value import finite
from lta_report.results_folder import keep_json
from lta_studies.energy.tables import Table
from lta_studies.reproduce.found import Found, Value


class Drawn(NamedTuple):
    """A picture as it is kept; `figure` is plotly's JSON."""

    name: str
    heading: str
    caption: str
    figure: str
    command: str
    bag: str


@final
@dataclass(frozen=True, slots=True)
class Kept:
    """What a row's study found, how many seeds it took, and how long. [s]"""

    values: Mapping[str, Value]
    pictures: Sequence[Drawn]
    tables: Sequence[Table]
    seeds: int
    seconds: float


def identity(row: PaperRow, seeds: int, quick: bool, code: str) -> str:
    """Return a hash of what decides a row: its file, the effort, and a hash of the code."""
    text = json.dumps([row.model_dump(mode='json'), seeds, quick, code], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def kept_of(found: Found, seeds: int, seconds: float) -> Kept:
    """Return what is kept of a study."""
    pictures = [
        Drawn(p.name, p.heading, p.caption, p.figure.to_json(), p.command, p.bag)
        for p in found.pictures
    ]
    return Kept(found.values, pictures, found.tables, seeds, seconds)


def write(place: Path, name: str, kept: Kept) -> None:
    """Keep a row under the hash of what decides it; it appears whole or not at all."""
    content = {
        'identity': name,
        'values': plain(kept.values),
        'pictures': [each._asdict() for each in kept.pictures],
        'tables': [asdict(each) for each in kept.tables],
        'seeds': kept.seeds,
        'seconds': kept.seconds,
    }
    place.parent.mkdir(parents=True, exist_ok=True)
    keep_json(content, place)


def read(place: Path, name: str) -> Kept | None:
    """Return a row that was kept under a hash; None where there is none."""
    try:
        content = json.loads(place.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return None
    if content.get('identity') != name:
        return None
    return Kept(
        values=values_in(content['values']),
        pictures=[Drawn(**each) for each in content['pictures']],
        tables=[Table(**each) for each in content['tables']],
        seeds=content['seeds'],
        seconds=content['seconds'],
    )


def plain(values: Mapping[str, Value]) -> dict[str, list[Any]]:
    """Return values as JSON has them: what is no number as null."""
    known: dict[str, list[Any]] = finite(values)
    return known


def values_in(content: Mapping[str, Sequence[Any]]) -> dict[str, Value]:
    """Return values of JSON."""
    return {name: value_in(each) for name, each in content.items()}


def value_in(content: Sequence[Any]) -> Value:
    """Return a value of JSON, what is null as NaN."""
    value, low, high = (math.nan if each is None else each for each in content[:3])
    return Value(value, low, high, content[3])
