"""Flights behind figures, flown again into bags with the files that they are made of."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from lta_bridge.bag.storage import StorageFault
from lta_bridge.bag.writer import BagWriter, prepare_empty_folder
from lta_bridge.provenance import collect_provenance
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight import ROBOT
from lta_flight.messages import LoopRecorder
from pydantic import AliasChoices, BaseModel
from pydantic.fields import FieldInfo
import yaml


def record_flight(
    loop: ClosedLoop, until: Callable[[ClosedLoop], bool], folder: Path, seed: int = 1
) -> None:
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
    prepare_empty_folder(folder)
    names = {
        name: write_yaml(content, folder / f'{name}.yaml')
        for name, content in collect_files(loop).items()
    }
    origin = collect_provenance(
        names['vehicle'], names['scenario'], names['gains'], strategy=loop.policy.strategy.name,
        law=loop.policy.law.name, seed=str(seed), time='lockstep', process='one, without DDS',
    )  # fmt: skip
    try:
        with BagWriter(folder / 'bag', origin) as writer:
            recorder = LoopRecorder(writer, loop, load_topic_table(), ROBOT)
            while not until(loop):
                loop.decide()
                recorder.record_step()
                loop.apply_command()
    except StorageFault as fault:
        raise BadInput(str(fault)) from None


def relative_bag_path(folder: Path) -> str:
    """Return how the page comes to a folder of bags: bags/ROW/FIGURE."""
    return str(Path(*folder.parts[-3:]))


def collect_files(loop: ClosedLoop) -> dict[str, Any]:
    """Return the files that a flight is made of, as YAML holds them."""
    gains = {'/**/controller': {'ros__parameters': {'gains': dump_model(loop.policy.gains)}}}
    world = loop.world
    return {
        'vehicle': dump_model(world.vehicle.file),
        'scenario': dump_model(world.scenario),
        'gains': gains,
    }


def dump_model(model: BaseModel) -> Any:  # noqa: ANN401 - what YAML holds
    """Return what a file's model holds, under the file's own names."""
    held = model.model_dump(mode='json', exclude_none=True)
    return {
        file_key(field, name): held[name]
        for name, field in type(model).model_fields.items()
        if name in held and held[name] != {}
    }


def file_key(field: FieldInfo, name: str) -> str:
    """Return how a file spells a field."""
    alias = field.validation_alias
    found = alias.choices[0] if isinstance(alias, AliasChoices) else alias
    return found if isinstance(found, str) else name


def write_yaml(content: Any, path: Path) -> str:  # noqa: ANN401 - what YAML holds
    """Write a file and return its name."""
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    return str(path)
