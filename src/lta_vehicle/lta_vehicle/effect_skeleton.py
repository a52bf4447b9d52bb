# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write the skeleton of an effect of one's own: its file, and the package that installs it."""

from importlib.util import find_spec
import keyword
from pathlib import Path
from string import Template
from typing import Final

from lta_config.errors import BadInput
from lta_model.effects import EFFECTS

EFFECT_FILE: Final = Template('''"""An effect of one's own: $name."""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS = (
    # Name, unit, null value, lowest, highest, typical deviation, source
    EffectParameter('damping', 'N s/m', 0.0, 0.0, 1.0, 0.002, 'an example; give a source'),
)


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    What the effect is, in one sentence.

        F_x = -damping u

    u is the forward airspeed. `VehicleMotion` lists what else the effect may depend on; `thrust`
    is that of each rotor [N]. A force along the axes of the map is brought to the body by
    `lta_model.rigid_body.to_body(motion.rotation, force)`.
    """
    (damping,) = p
    surge = -damping * motion.airspeed[0]
    # Force [N] and moment about the hull centre [N m], body frame
    return (surge, 0.0, 0.0, 0.0, 0.0, 0.0)


EFFECT = WrenchEffect('$name', PARAMETERS, compute_wrench, linear_in=('damping',))
''')
PROJECT_FILE: Final = Template("""[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"

[project]
name = "$name"
version = "0.1.0"

[tool.setuptools]
py-modules = ["$name"]

[project.entry-points."lta.effects"]
$name = "$name:EFFECT"
""")


def write_skeleton(name: str, folder: Path) -> list[Path]:
    """
    Write `NAME.py` and `pyproject.toml` into a new folder, and return their paths.

    Raise `BadInput` if the name is not free or valid, or the folder exists.
    """
    if not name.isidentifier() or name != name.lower() or name != name.strip('_'):
        raise BadInput(
            f"'{name}' cannot name an effect; use small letters and digits, with underscores "
            'between.'
        )
    if name in EFFECTS:
        raise BadInput(f'There is an effect {name} already; choose another name.')
    # The file is installed as a module of this name
    if keyword.iskeyword(name) or find_spec(name):
        raise BadInput(
            f"'{name}' cannot name an effect, as Python has a keyword or module of this name; "
            'choose another name.'
        )
    if folder.exists():
        raise BadInput(f'{folder} exists already; give another folder with --out.')
    folder.mkdir(parents=True)
    files = {
        folder / f'{name}.py': EFFECT_FILE.substitute(name=name),
        folder / 'pyproject.toml': PROJECT_FILE.substitute(name=name),
    }
    for path, content in files.items():
        path.write_text(content, encoding='utf-8')
    return list(files)
