# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Perform a request, from Python or from the command line: the one way into every study."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
import inspect
from pathlib import Path
import sys
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    cast,
    ForwardRef,
    get_args,
    get_origin,
    overload,
    ParamSpec,
    Protocol,
    TypeVar,
    Union,
)

from lta_analysis.console import plain_console, print_lines
from lta_analysis.result import StudyResult
from lta_bag.provenance import read_commit
from lta_config.atomic_file import create_folder, stage_results
from lta_config.errors import BadInput
from lta_report.browser import find_chromium
from lta_report.report import Report
from lta_report.report_page import PAGE, write_report
from lta_report.request import (
    Action,
    build_request,
    LocalStudyRequest,
    Outcome,
    ReportRequest,
    Request,
    StudyRun,
)
from lta_report.results_folder import check_creatable, resolve_folder
from lta_report.study import StudyOptions
from rich.console import Console

P = ParamSpec('P')
Value = TypeVar('Value')
SKIPPED = ('Exit status', 'Example')  # paragraphs of a help that are for the command line


def perform(request: ReportRequest, console: Console) -> StudyResult:
    """
    Run a request, write its results and return them.

    `console`: shows progress. Nothing is written before the study has returned, except finished
    work that a later run can resume. Raise `BadInput` if the request cannot be run.
    """
    if request.pictures is not None and not request.page:
        raise BadInput('--pictures needs the page; remove --no-page.')
    folder = resolve_folder(request.out, request.folder)
    options = request.options if isinstance(request, LocalStudyRequest) else StudyOptions()
    run = StudyRun(console, folder, request.out, options)
    check_picture_output(request.pictures)
    if not request.resumes:
        check_creatable(run.folder)
    try:
        short = request.shorten() if isinstance(request, LocalStudyRequest) else request
        report = short.run(run)
    except KeyboardInterrupt:
        # The default folder contains the time, so the same command would start again
        if request.resumes and any(run.folder.glob('*')):
            command = request.format_repetition(run.folder)
            print_lines(console, f'Finished work is stored; resume with: {command}')
        raise
    name = 'Resume or repeat this study' if request.resumes else 'Repeat this study'
    report = replace(
        report,
        facts={**report.facts, 'commit': read_commit()},
        commands={name: request.format_repetition(run.folder), **report.commands},
    )
    if run.writes:
        store_report(report, request, run.folder)
    page = run.folder / PAGE if request.page and run.writes else None
    return StudyResult(request, report, run.folder, page)


def store_report(report: Report, request: ReportRequest, folder: Path) -> None:
    """Write a report to its folder: all at once, or beside the finished work of the study."""
    if request.resumes:
        # A study may store its finished work elsewhere
        create_folder(folder)
    with nullcontext(folder) if request.resumes else stage_results(folder, PAGE) as place:
        write_report(report, place, page=request.page, pictures=request.pictures)


def check_picture_output(folder: Path | None) -> None:
    """Check, before any work, that pictures can be taken and written."""
    if folder is not None:
        find_chromium()  # raises BadInput if there is none
        # Not created yet: nothing is left behind if the work fails
        check_creatable(folder.absolute())


class Performed(Protocol[Value]):
    """What an action is to a type checker."""

    def run(self, console: Console) -> Outcome[Value]:
        """Do it, and return the outcome."""


@overload
def as_function(model: Callable[P, ReportRequest]) -> Callable[P, StudyResult]: ...


@overload
def as_function(model: Callable[P, Performed[Value]]) -> Callable[P, Value]: ...


def as_function(model: Callable[P, Any]) -> Callable[P, Any]:
    """Return the function that builds and performs a request; its arguments are the fields."""
    request_type = cast('type[Request]', model)

    def call(*values: object, **named: object) -> Any:
        names = request_type.list_fields()
        request = build_request(request_type, dict(zip(names, values, strict=False)) | named)
        # Progress goes to stderr, in a notebook below the cell
        console = plain_console(stderr='ipykernel' not in sys.modules)
        if isinstance(request, ReportRequest):
            return perform(request, console)
        return cast('Action', request).run(console).value

    call.__name__ = call.__qualname__ = request_type.command.replace(' ', '_')
    call.__doc__ = describe_function(request_type)
    call.__signature__ = build_signature(request_type)  # type: ignore[attr-defined]
    return call


def build_signature(model: type[Request]) -> inspect.Signature:
    """Return the signature of the function of a request: its fields, the shared ones by name."""
    empty, parameters = inspect.Parameter.empty, []
    for name in model.list_fields():
        field = model.model_fields[name]
        own = name in model.__annotations__
        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD if own else inspect.Parameter.KEYWORD_ONLY
        default = empty if field.is_required() else field.default
        parameters.append(
            inspect.Parameter(name, kind, default=default, annotation=name_type(field.annotation))
        )
    # Fields without a default may follow others
    parameters.sort(key=lambda each: (each.kind, each.default is not empty))
    return inspect.Signature(parameters, return_annotation=find_return_type(model))


def describe_function(model: type[Request]) -> str:
    """Return the documentation of the function of a request, in the form of numpydoc."""
    paragraphs = (inspect.getdoc(model) or '').split('\n\n')
    lines = ['\n\n'.join(part for part in paragraphs if not part.startswith(SKIPPED)), '']
    lines += ['Parameters', '----------']
    for name in model.list_fields():
        field = model.model_fields[name]
        optional = '' if field.is_required() else f', default {field.default!r}'
        lines += [
            f'{name} : {name_type(field.annotation)}{optional}',
            f'    {model.describe(name)}',
        ]
    lines += ['', 'Returns', '-------']
    if issubclass(model, ReportRequest):
        lines += ['StudyResult', '    Headline, tables, figures and data.']
    else:
        # As the summary of `run` says
        summary = inspect.getdoc(cast('type[Action]', model).run)
        lines += [name_type(find_return_type(model)), f'    {summary}']
    return '\n'.join(lines) + '\n'


def find_return_type(model: type[Request]) -> object:
    """Return what the function of a request returns, a type or its name."""
    if issubclass(model, ReportRequest):
        return StudyResult
    (value,) = get_args(inspect.signature(cast('type[Action]', model).run).return_annotation)
    return value.__forward_arg__ if isinstance(value, ForwardRef) else value


def name_type(annotation: object) -> str:
    """Return a type as it is written, such as 'int | None'."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return name_type(inner[0])
    if origin in (Union, UnionType):
        return ' | '.join(map(name_type, inner))
    if inner:
        of_items = ', '.join(
            repr(each) if isinstance(each, str) else name_type(each) for each in inner
        )
        return f'{getattr(origin, "__name__", "Literal")}[{of_items}]'
    if annotation is Ellipsis:
        return '...'
    if isinstance(annotation, str):
        return annotation
    return 'None' if annotation is NoneType else getattr(annotation, '__name__', str(annotation))
