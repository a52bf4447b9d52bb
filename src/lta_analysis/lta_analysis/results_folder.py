"""Where the results of a verb go: their folder, what is written into it, how a page is named."""

from collections.abc import Mapping
from datetime import datetime
import json
from pathlib import Path
import shlex
from typing import Any

from lta_config.errors import BadInput


def results_folder(out: Path | None, name: str) -> Path:
    """Return the whole path of the folder that was asked for, else of runs/<time>-<name>."""
    stamp = datetime.now().astimezone().strftime('%Y%m%d-%H%M%S')
    return (out or Path('runs') / f'{stamp}-{name}').absolute()


def keep_json(content: Mapping[str, Any] | list[Any], place: Path) -> str:
    """Write results as JSON and return the text; `BadInput` where the disk does not take it."""
    text = json.dumps(content, indent=1) + '\n'
    try:
        place.write_text(text, encoding='utf-8')
    except OSError as error:
        raise BadInput(
            f"'{place}' cannot be written ({error.strerror}); make room, or choose another folder "
            'with --out.'
        ) from error
    return text


def page_line(page: Path) -> str:
    """Return the line that says where a page is and how to look at it."""
    return f'Page {page}  (open it in a browser: xdg-open {shlex.quote(str(page))})'
