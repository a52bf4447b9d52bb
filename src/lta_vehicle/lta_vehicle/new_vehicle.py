"""A vehicle file to start from: a copy of one that flies, comments and all, under another name."""

from pathlib import Path
import re

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_model.vehicle import load_vehicle

NAME = re.compile(r'[a-z][a-z0-9_]*')
LINE = re.compile(r'(?m)^name:[ \t]*\S.*$')
HEAD = """\
# {name}: begun as a copy of {model}.
#
# Put in your own numbers, one by one. Weigh each part, measure its place from the hull centre,
# and write where the number comes from: "measured, kitchen scale", "data sheet", or "assumed"
# where it is a guess. Then:
#   lta vehicle check {file}      what is wrong with it
#   lta vehicle show {file}       what it is and can do
#   lta vehicle diff {model} {file}      what that changed
# What follows was written about {model}.
#
"""


def format_new_vehicle(name: str, model: str) -> str:
    """
    Return the text of a new vehicle file.

    Parameters
    ----------
    name : str
        Of the new vehicle: small letters, digits and underscores.
    model : str
        Vehicle name or file to copy.

    Raises
    ------
    BadInput
        If the name is none, or the model cannot be read.

    """
    if not NAME.fullmatch(name):
        raise BadInput(
            f"'{name}' cannot name a vehicle; take small letters, digits and underscores, with a "
            'letter first.'
        )
    copied = load_vehicle(model).file.name  # a file that is broken is no start
    text = find_file('vehicle', model).read_text(encoding='utf-8')
    renamed, count = LINE.subn(f'name: {name}', text, count=1)
    if count != 1:
        raise BadInput(f"{find_file('vehicle', model)} has no line 'name: ...'; write one.")
    return HEAD.format(name=name, model=copied, file=f'{name}.yaml') + renamed


def write_new_vehicle(name: str, model: str, out: Path) -> None:
    """Write a new vehicle file; `BadInput` if it is there already or cannot be written."""
    text = format_new_vehicle(name, model)
    try:
        with out.open('x', encoding='utf-8') as stream:
            stream.write(text)
    except FileExistsError:
        raise BadInput(f'{out} is there already; choose another place with --out.') from None
    except OSError as error:
        raise BadInput(f'{out} cannot be written ({error.strerror}); choose another.') from None
    load_vehicle(str(out.absolute()))
