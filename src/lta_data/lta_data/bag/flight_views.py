# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Turn tables of a flight into a dataset of xarray and into lines of matplotlib."""

from collections.abc import Mapping, Sequence
from importlib import import_module
import re
from typing import Any, Final

from lta_config.errors import BadInput, unknown_name_error
from lta_data.bag.table import FIXED_UNITS, STAMP_COLUMN, Table, TIME_INDEX

TWIST_COLUMNS: Final = 'twist.'  # columns of an odometry that are in the frame of its child
CHILD_FRAME: Final = 'child_frame_id'
MISSING_PACKAGE: Final = (
    'This needs {}, which is not installed; run "pip install {}", in a source tree '
    '".venv/bin/pip install -c constraints.txt -r requirements-notebook.txt".'
)


def import_notebook_package(name: str) -> Any:
    """Return a module of the `notebook` extra; raise `BadInput` if it is not installed."""
    try:
        return import_module(name)
    except ImportError as error:
        package = name.partition('.')[0]
        raise BadInput(MISSING_PACKAGE.format(package, package)) from error


def find_frame(table: Table, column: str) -> str:
    """Return the frame of a column of a topic's table; '' if it has none, or several."""
    is_twist = column.startswith(TWIST_COLUMNS) and CHILD_FRAME in table
    frames = table.get(CHILD_FRAME if is_twist else 'header.frame_id', ())
    return str(frames.iloc[0]) if len({*frames}) == 1 else ''


def build_dataset(aligned: Table, tables: Mapping[str, Table]) -> Any:
    """
    Return an aligned table as an `xarray.Dataset` over `time`, with `stamp_ns` beside it.

    Variables are named 'odom.pose.pose.position.x', as netCDF takes no '/' in a name, and have
    `attrs` `units` and `frame` where they are known. `tables`: those of the topics, by topic.
    """
    xarray = import_notebook_package('xarray')
    variables = {}
    # A topic may begin with the name of another one
    for topic, table in sorted(tables.items(), key=lambda each: len(each[0])):
        for name in aligned.filter(regex=f'^{re.escape(topic)}/'):
            unit = aligned.attrs['units'].get(name)
            frame = find_frame(table, name.removeprefix(f'{topic}/'))
            attributes = {
                **({'units': unit} if unit else {}),
                **({'frame': frame} if frame else {}),
            }
            variables[name.replace('/', '.')] = (TIME_INDEX, aligned[name].to_numpy(), attributes)
    coordinates = {
        TIME_INDEX: (TIME_INDEX, aligned.index.to_numpy(), {'units': FIXED_UNITS[TIME_INDEX]}),
        STAMP_COLUMN: (
            TIME_INDEX,
            aligned[STAMP_COLUMN].to_numpy(),
            {'units': FIXED_UNITS[STAMP_COLUMN]},
        ),
    }
    return xarray.Dataset(variables, coordinates, {'start_ns': aligned.attrs['start']})


def draw_columns(table: Table, columns: Sequence[str], axes: Any) -> Any:
    """
    Draw columns of a topic over time, in new axes if `axes` is None, and return the axes.

    Raise `BadInput` if a column is unknown, or the columns have several units.
    """
    topic, units = table.attrs['topic'], table.attrs['units']
    numbers = [*table.select_dtypes(['number', 'bool'])]
    if not columns:
        raise BadInput(f'No columns to plot were named; choose from: {", ".join(numbers)}.')
    chosen: list[str] = []
    for column in columns:
        inside = (f'{column}.', f'{column}[')
        group = [name for name in numbers if name == column or name.startswith(inside)]
        if not group:
            raise unknown_name_error(f'column of {topic}', column, numbers)
        chosen += group
    several = sorted({units.get(name, 'unknown') for name in chosen})
    if len(several) > 1:
        raise BadInput(
            f'The columns of {topic} to plot have several units ({", ".join(several)}); plot '
            'those of one unit at a time.'
        )
    if axes is None:
        _, axes = import_notebook_package('matplotlib.pyplot').subplots(layout='constrained')
    for name in chosen:
        axes.plot(table.index, table[name], label=f'{topic} {name}')
    axes.set_xlabel(f'{TIME_INDEX} [{FIXED_UNITS[TIME_INDEX]}]')
    axes.set_ylabel(f'{", ".join(columns)} [{several[0]}]')
    axes.legend()
    return axes
