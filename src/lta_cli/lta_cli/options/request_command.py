"""Turn a request into a command of Typer: each of its fields is an option or an argument."""

from collections.abc import Mapping
import inspect
from types import NoneType, UnionType
from typing import Annotated, Any, Final, get_args, get_origin, Literal, Union

from lta_analysis.console import plain_console
from lta_analysis.door import perform
from lta_cli.options.common_options import complete_names, Json, print_json
from lta_config.command_line import relative_path
from lta_report.report_terminal import print_report
from lta_report.request import build_request, ReportRequest
from lta_report.results_folder import format_page_line
from pydantic import BeforeValidator
import typer

JSON: Final = 'json'


def build_command(model: type[ReportRequest]) -> Any:  # noqa: ANN401 - a function that Typer inspects
    """Return the function of a command, with the help and the options of a request."""

    def command(context: typer.Context, **values: Any) -> None:  # noqa: ANN401 - the options
        json = values.pop(JSON, False)
        # What is left at its default is not passed on, as --quick may preset it
        own = {name: each for name, each in values.items() if not is_unset(context, name)}
        run_request(build_request(model, own, model.name_option), json)

    kind = inspect.Parameter.KEYWORD_ONLY
    parameters = [inspect.Parameter('context', kind, annotation=typer.Context)]
    parameters += [build_parameter(model, name) for name in model.list_fields()]
    parameters.append(inspect.Parameter(JSON, kind, default=False, annotation=Json))
    command.__doc__ = model.__doc__
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return command


def is_unset(context: typer.Context, name: str) -> bool:
    """Return whether the command line leaves an option at its default."""
    source = context.get_parameter_source(name)
    return source is None or source.name == 'DEFAULT'


def build_parameter(model: type[ReportRequest], name: str) -> inspect.Parameter:
    """Return the declaration of a field for Typer."""
    field, declared = model.model_fields[name], model.read_declaration(name)
    texts: dict[str, Any] = {'help': model.describe(name), 'metavar': declared.get('metavar')}
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


def find_click_type(annotation: Any) -> Any:  # noqa: ANN401 - a type
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


def run_request(request: ReportRequest, json: bool) -> None:
    """Perform a request, print its report, and exit with its status unless that is 0."""
    console = plain_console(stderr=json)
    result = perform(request, console)
    if json:
        print_json(result.data, result.page)
    print_report(result.report, console)
    if result.page is not None:
        console.print(
            format_page_line(relative_path(result.page)),
            highlight=False, markup=False, soft_wrap=True,
        )  # fmt: skip
    if result.report.status:
        raise typer.Exit(result.report.status)
