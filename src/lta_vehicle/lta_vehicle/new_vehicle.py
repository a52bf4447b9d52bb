"""Create a vehicle file as a renamed copy of an existing one, comments included."""

from pathlib import Path
import re

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_model.vehicle import load_vehicle

NAME = re.compile(r'[a-z][a-z0-9_]*')
# The top-level key only: nested keys are indented
LINE = re.compile(r'(?m)^name:[ \t]*\S.*$')
HEAD = """\
# {name}: copied from {model}.
#
# Replace the numbers with your own. Weigh each part, measure its position from the hull centre,
# and give the source of each number: "measured, kitchen scale", "data sheet", or "assumed" if
# it is a guess. Then:
#   lta vehicle check {file}      check it for errors
#   lta vehicle show {file}       show its properties and performance
#   lta vehicle diff {model} {file}      show what your changes did
# The rest of this file was written for {model}.
#
"""


def check_vehicle_name(name: str) -> None:
    """Raise `BadInput` for an invalid name of a vehicle."""
    if not NAME.fullmatch(name):
        raise BadInput(
            f"Invalid vehicle name '{name}'; use lower-case letters, digits and "
            'underscores, and begin with a letter.'
        )


def format_new_vehicle(name: str, model: str) -> str:
    """
    Return the text of a new vehicle file.

    `name`: name of the new vehicle: lower-case letters, digits and underscores. `model`: vehicle
    name or file to copy. Raise `BadInput` if the name is invalid, or the model cannot be read.
    """
    check_vehicle_name(name)
    copied = load_vehicle(model).file.name  # raises BadInput if the model itself is invalid
    text = find_file('vehicle', model).read_text(encoding='utf-8')
    # Edit the text and not the parsed YAML, which would lose the comments
    renamed, count = LINE.subn(f'name: {name}', text, count=1)
    if count != 1:
        raise BadInput(f"{find_file('vehicle', model)} has no line 'name: ...'; add one.")
    return HEAD.format(name=name, model=copied, file=f'{name}.yaml') + renamed


def write_new_vehicle(name: str, model: str, out: Path) -> None:
    """Write a new vehicle file; raise `BadInput` if it exists or cannot be written."""
    write_new_file(out, format_new_vehicle(name, model))
    load_vehicle(str(out.absolute()))  # the copy must be valid under its new name


def write_new_file(out: Path, text: str) -> None:
    """Write a file; raise `BadInput` if it exists or cannot be written."""
    try:
        # Mode 'x' never overwrites an existing file
        with out.open('x', encoding='utf-8') as stream:
            stream.write(text)
    except FileExistsError:
        raise BadInput(f'{out} already exists; choose another one with --file.') from None
    except OSError as error:
        raise BadInput(
            f'{out} cannot be written ({error.strerror}); choose another one with --file.'
        ) from None
