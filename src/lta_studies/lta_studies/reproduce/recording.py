"""Record the flights shown in figures as bags, with their input files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from lta_bridge.bag.storage import StorageFault
from lta_bridge.bag.writer import BagWriter, prepare_empty_folder
from lta_bridge.provenance import collect_provenance
from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_flight.closed_loop import ClosedLoop
from lta_flight.flight_run import ROBOT
from lta_flight.messages import LoopRecorder
from pydantic import AliasChoices, BaseModel
from pydantic.fields import FieldInfo
import yaml


def record_flight(
    loop: ClosedLoop, until: Callable[[ClosedLoop], bool], folder: Path, seed: int = 1
) -> None:
    """
    Fly a loop until a condition holds, and record it in a bag.

    `loop`: the flight before its first step. `until`: called with the loop before each step; ends
    the flight if true. `folder`: empty folder for the bag and for the vehicle, scenario and gains
    files. Raise `BadInput` if the folder is not empty, or the bag cannot be written.
    """
    prepare_empty_folder(folder)
    names = {
        name: write_yaml(content, folder / f'{name}.yaml')
        for name, content in collect_flight_files(loop).items()
    }
    origin = collect_provenance(
        names['vehicle'], names['scenario'], names['gains'], strategy=loop.policy.strategy.name,
        law=loop.policy.law.name, seed=str(seed), time='lockstep', process='one, without DDS',
    )  # fmt: skip
    try:
        with BagWriter(folder / 'bag', origin) as writer:
            recorder = LoopRecorder(writer, loop, load_topic_table(), ROBOT)
            for _ in loop.iterate_until(lambda: until(loop)):
                recorder.record_step()
    # A full disk is a problem of the user's input (the folder), not of the program.
    except StorageFault as fault:
        raise BadInput(str(fault)) from None


def relative_bag_path(folder: Path) -> str:
    """Return the path of a folder of bags relative to the page: bags/ROW/FIGURE."""
    # The last three parts of the path
    return str(Path(*folder.parts[-3:]))


def collect_flight_files(loop: ClosedLoop) -> dict[str, Any]:
    """Return the contents of the vehicle, scenario and gains files of a flight."""
    gains = {'/**/controller': {'ros__parameters': {'gains': dump_model(loop.policy.gains)}}}
    world = loop.world
    return {
        'vehicle': dump_model(world.vehicle.file),
        'scenario': dump_model(world.scenario),
        'gains': gains,
    }


def dump_model(model: BaseModel) -> Any:  # noqa: ANN401 - what YAML holds
    """Return the content of a model under the keys of its file."""
    held = model.model_dump(mode='json', exclude_none=True)
    return {
        file_key(field, name): held[name]
        for name, field in type(model).model_fields.items()
        # Empty mappings are defaults that the file left out.
        if name in held and held[name] != {}
    }


def file_key(field: FieldInfo, name: str) -> str:
    """Return the key of a field in the file, which may be an alias."""
    alias = field.validation_alias
    key = alias.choices[0] if isinstance(alias, AliasChoices) else alias
    return key if isinstance(key, str) else name


def write_yaml(content: Any, path: Path) -> str:  # noqa: ANN401 - what YAML holds
    """Write a file and return its name."""
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding='utf-8')
    return str(path)
