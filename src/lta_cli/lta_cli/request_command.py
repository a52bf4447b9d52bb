# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Turn a request into a command of Typer: each of its fields is an option or an argument."""

from collections.abc import Callable, Mapping
import inspect
import json as json_text
import sys
from types import NoneType, UnionType
from typing import Annotated, Any, Final, get_args, get_origin, Literal, Union

from lta_analysis.console import plain_console
from lta_config.files import KIND_FOLDERS, list_shipped_names
from lta_report.request import Action, build_request, ReportRequest, Request
from pydantic import BeforeValidator
import typer

JSON_FIELD: Final = 'json'
# JSON goes to stdout, tables then go to stderr
Json = Annotated[bool, typer.Option('--json', help='Print the results as JSON.')]


def complete_names(kind: str) -> Callable[[str], list[str]]:
    """Return the function with which a shell completes the name of a shipped file."""

    def find(incomplete: str) -> list[str]:
        return [
            name for name in list_shipped_names(KIND_FOLDERS[kind]) if name.startswith(incomplete)
        ]

    return find


def print_json(content: Any) -> None:
    """Print results."""
    # One write for the whole text, so that other output cannot split it
    sys.stdout.write(json_text.dumps(content, indent=1) + '\n')


def build_command(model: type[Request]) -> Any:
    """Return the function of a command, with the help and the options of a request."""

    def command(context: typer.Context, **values: Any) -> None:
        json = values.pop(JSON_FIELD, False)
        # What is left at its default is not passed on, as --quick may preset it
        own = {name: each for name, each in values.items() if not is_unset(context, name)}
        run_request(build_request(model, own, model.name_option), json)

    kind = inspect.Parameter.KEYWORD_ONLY
    parameters = [inspect.Parameter('context', kind, annotation=typer.Context)]
    parameters += [build_parameter(model, name) for name in model.list_fields()]
    if not issubclass(model, Action) or model.prints_json:
        parameters.append(inspect.Parameter(JSON_FIELD, kind, default=False, annotation=Json))
    command.__doc__ = model.__doc__
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return command


def is_unset(context: typer.Context, name: str) -> bool:
    """Return whether the command line leaves an option at its default."""
    source = context.get_parameter_source(name)
    return source is None or source.name == 'DEFAULT'


def build_parameter(model: type[Request], name: str) -> inspect.Parameter:
    """Return the declaration of a field for Typer."""
    field, declared = model.model_fields[name], model.read_declaration(name)
    texts: dict[str, Any] = {'help': model.describe(name), 'metavar': declared.get('metavar')}
    if 'unit' not in declared:  # Typer would show the bounds in SI
        texts |= {'min': declared.get('low'), 'max': declared.get('high')}
    if kind := declared.get('complete'):
        texts['autocompletion'] = complete_names(kind)
    annotation = find_click_type(field.annotation)
    if any(isinstance(each, BeforeValidator) for each in field.metadata):
        # The request parses the text
        annotation = annotation if get_origin(annotation) is list else str
    default = inspect.Parameter.empty if field.is_required() else field.default
    default = list(default) if isinstance(default, tuple | Mapping) else default
    if not default and get_origin(annotation) is list and not field.is_required():
        default = None
    if default is None:
        annotation = annotation | None
    if declared.get('positional'):
        declaration = typer.Argument(**texts)
    else:
        if 'default_text' in declared:
            texts['show_default'] = declared['default_text']
        word = model.name_option(name)
        word = f'{word}/--no-{word[2:]}' if default is True else word
        declaration = typer.Option(word, **texts)
    return inspect.Parameter(
        name,
        inspect.Parameter.KEYWORD_ONLY,
        default=default,
        annotation=Annotated[annotation, declaration],
    )


def find_click_type(annotation: Any) -> Any:
    """Return the type that Click parses: text for what the request parses itself."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return find_click_type(next(each for each in inner if each is not NoneType))
    if origin is tuple:
        return list[find_click_type(inner[0])]  # type: ignore[misc]
    if origin is dict:
        return list[str]
    if origin is Literal or origin is None:
        return annotation
    return str


def run_request(request: Request, json: bool) -> None:
    """Perform a request, print what it returns, and exit with its status unless that is 0."""
    console = plain_console(stderr=json)
    if isinstance(request, ReportRequest):
        from lta_analysis.door import perform  # it loads Plotly, which an action does without

        result = perform(request, console)
        result.print(console)
        data, status = result.to_json(), result.report.status
    else:
        assert isinstance(request, Action)
        outcome = request.run(console)
        data, status = outcome.to_json(), outcome.status
    if json and data is not None:
        print_json(data)
    if status:
        raise typer.Exit(status)
