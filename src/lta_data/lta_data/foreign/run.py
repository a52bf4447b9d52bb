"""An import from the first look at the files to the bags; all of it stays, or nothing."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

from lta_bridge.bag.storage import StorageFault
from lta_bridge.bag.writer import empty_folder
from lta_config.errors import BadInput, one_line
from lta_data.bag.folder import bag_in
from lta_data.foreign.choice import choose, mapping_for, strangers
from lta_data.foreign.formats import named, recognised
from lta_data.foreign.origin import origin
from lta_data.foreign.progress import ImportProgress
from lta_data.foreign.protocol import Reached
from lta_data.foreign.writing import write
from lta_report.results_folder import all_at_once

BAG = 'bag'  # as a flight's results folder has it


@final
@dataclass(frozen=True, slots=True)
class Order:
    """What to import, how it is to be read, and whose topics it becomes."""

    sources: Sequence[Path]
    mapping: str | None = None
    format: str | None = None
    robot: str = 'lta1'
    vehicle: str | None = None


@final
@dataclass(slots=True)
class Imported:
    """
    One imported log.

    Attributes
    ----------
    source, bag : str
        What was read, and the bag that was made of it.
    format, mapping : str
        How it was read; no mapping is ''.
    data : str
        'measured' or 'simulated', as the mapping says.
    topics : dict of str to int
        Messages by topic.
    notes : list of str
        What is odd, missing or was left out, one sentence each.

    """

    source: str
    bag: str
    format: str
    mapping: str
    data: str
    topics: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def import_all(order: Order, out: Path, progress: ImportProgress) -> list[Imported]:
    """
    Import logs into a folder: `out/bag` of one, `out/NAME/bag` of each of several.

    Raises
    ------
    BadInput
        If one of them cannot be imported: then there is no bag of any.

    """
    done = []
    if out.exists():
        empty_folder(out)
    with all_at_once(out, BAG) as folder:
        for source, name in zip(order.sources, _names(order.sources), strict=True):
            progress.begin(source.name)
            inside = Path(name) / BAG if len(order.sources) > 1 else Path(BAG)
            found = _imported(order, bag_in(source), folder / inside, progress.reached)
            found.bag = str(out / inside)
            done.append(found)
            progress.end()
    return done


def _names(sources: Sequence[Path]) -> list[str]:
    """Return a folder's name for each source: its own without suffixes, each once."""
    found: list[str] = []
    for source in sources:
        stem = source.name.split('.')[0] or 'log'
        count = sum(name == stem or name.startswith(f'{stem}-') for name in found)
        found.append(f'{stem}-{count + 1}' if stem in found else stem)
    return found


def _imported(order: Order, source: Path, bag: Path, reached: Reached) -> Imported:
    """Import one log."""
    format_ = recognised(source) if order.format is None else order.format
    named(format_)
    mapping, text = mapping_for(source, format_, order.mapping)
    told = origin(source, format_, mapping, text, order.vehicle)
    try:
        log = named(format_).opened(source, mapping)
        chosen = choose(source, mapping, log, order.robot)
        found = Imported(
            str(source), str(bag), format_, mapping.name if mapping else '', told['data']
        )
        strange = [] if order.vehicle is None else strangers(order.vehicle, chosen)
        found.topics, found.notes = write(log, chosen, bag, told, reached)
        found.notes = [one_line(note) for note in [*found.notes, *strange]]
    except (OSError, StorageFault) as fault:
        reason = str(fault).rstrip('.')
        raise BadInput(f"'{source}' cannot be imported: {reason}.") from None
    return found
