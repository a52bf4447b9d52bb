"""Flights behind figures, flown again into bags with the files that they are made of."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from lta_bridge.bag.storage import StorageFault
from lta_bridge.bag.writer import BagWriter, empty_folder
from lta_bridge.provenance import provenance
from lta_config.errors import BadInput
from lta_config.topics import topic_table
from lta_flight.flight import ROBOT
from lta_flight.loop import Loop
from lta_flight.messages import LoopRecorder
from pydantic import AliasChoices, BaseModel
from pydantic.fields import FieldInfo
import yaml


def record(loop: Loop, until: Callable[[Loop], bool], folder: Path, seed: int = 1) -> None:
    """
    Fly a loop until something is so, into a bag below an empty folder.

    Parameters
    ----------
    loop : Loop
        A flight that is about to begin.
    until : callable
        Told the loop before each step.
    folder : Path
        Of the bag, and of vehicle, scenario and gains as they were flown.
    seed : int
        With which the loop was made.

    Raises
    ------
    BadInput
        If the folder holds something, or the disk cannot take the bag.

    """
    empty_folder(folder)
    names = {
        name: write(content, folder / f'{name}.yaml') for name, content in files(loop).items()
    }
    origin = provenance(
        names['vehicle'], names['scenario'], names['gains'], strategy=loop.policy.strategy.name,
        law=loop.policy.law.name, seed=str(seed), time='lockstep', process='one, without DDS',
    )  # fmt: skip
    try:
        with BagWriter(folder / 'bag', origin) as writer:
            recorder = LoopRecorder(writer, loop, topic_table(), ROBOT)
            while not until(loop):
                loop.decide()
                recorder.take()
                loop.act()
    except StorageFault as fault:
        raise BadInput(str(fault)) from None


def way(folder: Path) -> str:
    """Return how the page comes to a folder of bags: bags/ROW/FIGURE."""
    return str(Path(*folder.parts[-3:]))


def files(loop: Loop) -> dict[str, Any]:
    """Return the files that a flight is made of, as YAML holds them."""
    gains = {'/**/controller': {'ros__parameters': {'gains': plain(loop.policy.gains)}}}
    world = loop.world
    return {
        'vehicle': plain(world.vehicle.file),
        'scenario': plain(world.scenario),
        'gains': gains,
    }


def plain(model: BaseModel) -> Any:  # noqa: ANN401 - what YAML holds
    """Return what a file's model holds, under the file's own names."""
    held = model.model_dump(mode='json', exclude_none=True)
    return {
        spelled(field, name): held[name]
        for name, field in type(model).model_fields.items()
        if name in held and held[name] != {}
    }


def spelled(field: FieldInfo, name: str) -> str:
    """Return how a file spells a field."""
    alias = field.validation_alias
    found = alias.choices[0] if isinstance(alias, AliasChoices) else alias
    return found if isinstance(found, str) else name


def write(content: Any, path: Path) -> str:  # noqa: ANN401 - what YAML holds
    """Write a file and return its name."""
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    return str(path)
