# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The result of a study in a notebook: it shows itself, and gives its numbers to pandas."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, final, TYPE_CHECKING

from lta_analysis.console import print_lines
from lta_config.command_line import relative_path
from lta_config.errors import BadInput
from lta_report.report import Block, Grid, Picture, Report, ReportSection, TextTable
from lta_report.report_page import render_table_section
from lta_report.report_terminal import print_report
from lta_report.request import ReportRequest
from lta_report.results_folder import format_page_line
from rich.console import Console

if TYPE_CHECKING:
    from pandas import DataFrame
    from plotly.graph_objects import Figure

TABLE = 'table'  # entry of the results with the path of a Parquet file, one row for each item


@final
@dataclass(frozen=True, slots=True, repr=False)
class StudyResult:
    """
    What a study found; a notebook shows its headline and tables.

    Attributes
    ----------
    request : ReportRequest
        What was run; `request.model_dump()` is the record of it.
    report : Report
        Headline, tables and figures.
    folder : Path
        Folder of the results.
    page : Path, optional
        Page of the results in it, unless `page=False`.

    """

    request: ReportRequest
    report: Report
    folder: Path
    page: Path | None

    def __getitem__(self, name: str) -> Any:
        """Return an entry of the results, in SI units."""
        return self.report.data[name]  # type: ignore[call-overload]

    @property
    def data(self) -> Any:
        """Return the content of the JSON file, in SI units."""
        return self.report.data

    def to_json(self) -> Any:
        """Return the content of the JSON file, with the path of the page if it has names."""
        named = self.page is not None and isinstance(self.data, Mapping)
        return {**self.data, 'page': str(self.page)} if named else self.data

    def print(self, console: Console) -> None:
        """Print the report, and where its page is."""
        print_report(self.report, console)
        if self.page is not None:
            print_lines(console, format_page_line(relative_path(self.page)))

    @property
    def tables(self) -> dict[str, TextTable]:
        """Return the tables of the page, by heading."""
        blocks = iterate_blocks(self.report.blocks)
        return {each.heading: each for each in blocks if isinstance(each, TextTable)}

    @property
    def figures(self) -> 'dict[str, Figure]':
        """Return the figures of the page, by name; each shows itself."""
        blocks = iterate_blocks(self.report.blocks)
        return {each.name: each.figure for each in blocks if isinstance(each, Picture)}

    def to_pandas(self, name: str | None = None) -> 'DataFrame':
        """
        Return rows of the results as a table, in SI units.

        `name`: an entry of `data` that has rows, in a list or by name; the longest list by
        default. Nested values get columns such as 'vehicle.mass'. Raise `BadInput` if there is no
        such entry.
        """
        import pandas as pd  # slow to import

        content = self.data if isinstance(self.data, dict) else {'rows': self.data}
        if name is None and TABLE in content:
            return pd.read_parquet(content[TABLE])
        tables = {key: value for key, value in content.items() if has_rows(value)}
        lists = [key for key, value in tables.items() if isinstance(value, list)]
        key = max(lists, key=lambda key: len(tables[key]), default='') if name is None else name
        if key not in tables:
            raise BadInput(
                f"'{key}' has no rows in these results; choose one of: "
                f'{", ".join(tables) or "none"}.'
            )
        rows = tables[key]
        if isinstance(rows, list):
            return pd.json_normalize(rows)
        return pd.json_normalize([*rows.values()]).set_index(pd.Index(rows, name=key))

    def __repr__(self) -> str:
        """Return the headline."""
        return f'{self.report.command}: {self.report.headline}'

    def _repr_html_(self) -> str:
        """Return headline and tables for a notebook."""
        tables = ''.join(map(render_table_section, self.tables.values()))
        page = '' if self.page is None else f'<p><code>{escape(str(self.page))}</code></p>'
        return f'<h3>{escape(self.report.headline)}</h3>{tables}{page}'


def has_rows(value: object) -> bool:
    """Return whether an entry of the results is a list of rows, or has rows by name."""
    rows = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return bool(rows) and all(isinstance(row, dict) for row in rows)


def iterate_blocks(blocks: 'Iterator[Block] | Any') -> Iterator[Block]:
    """Yield all blocks, also those inside others."""
    for block in blocks:
        if isinstance(block, Grid | ReportSection):
            yield from iterate_blocks(block.blocks)
        else:
            yield block
