"""Refuse hostile bags before rosbags reads them."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
import sqlite3

from lta_config.errors import BadInput
from lta_config.files import load_yaml, parse_yaml
from lta_config.limits import CHUNK_BYTES, INFLATED_FREELY, INFLATION
from lta_data.bag.bag_folder import natural_sort_key
import zstandard

METADATA = 'metadata.yaml'
QOS = 'offered_qos_profiles'
PIECE = 1 << 20  # bytes
# Views, triggers and generated columns run SQL, perhaps without end; a bag has none.
PROGRAMS = "SELECT name FROM sqlite_master WHERE type IN ('view', 'trigger') OR sql LIKE ?"
COMPUTED = (2, 3)  # `hidden` values of generated columns in table_xinfo


def find_files(path: Path) -> list[Path]:
    """Return the files of a rosbag2 folder in their order, or the one file."""
    return sorted(path.iterdir(), key=natural_sort_key) if path.is_dir() else [path]


def has_metadata(path: Path) -> bool:
    """Return whether a folder has a metadata.yaml, which a killed recorder does not write."""
    return (path / METADATA).is_file()


def refuse_hostile_bag(path: Path, files: Sequence[Path]) -> None:
    """
    Raise BadInput for a bag that could block rosbags or fill the disk.

    `path` is a rosbag2 folder, or one file; `files` are what it holds.
    """
    if has_metadata(path):
        described = load_yaml(path / METADATA)
        for text in iterate_qos_texts(described):
            parse_yaml(text, f"The QoS in '{path / METADATA}'")
    for file in files:
        if file.suffix in ('.zstd', '.zst'):
            refuse_decompression_bomb(file)


def iterate_qos_texts(held: object) -> Iterator[str]:
    """Yield every text of a metadata.yaml that rosbags parses as YAML again."""
    if isinstance(held, dict):
        for key, inside in held.items():
            if key == QOS and isinstance(inside, str):
                yield inside
            yield from iterate_qos_texts(inside)
    elif isinstance(held, list):
        for inside in held:
            yield from iterate_qos_texts(inside)


def refuse_decompression_bomb(file: Path) -> None:
    """Raise BadInput for a compressed file that would fill the disk."""
    done, allowed = 0, INFLATED_FREELY + INFLATION * file.stat().st_size
    try:
        with file.open('rb') as packed:
            stream = zstandard.ZstdDecompressor().stream_reader(packed)
            while piece := stream.read(PIECE):
                done += len(piece)
                if done > allowed:
                    raise BadInput(
                        f"'{file}' unpacks to more than {INFLATION} times its size, which no "
                        'recording does; get it from a trusted source.'
                    )
    except zstandard.ZstdError as error:
        raise BadInput(
            f"'{file}' cannot be unpacked ({error}); it is probably damaged, so copy it again."
        ) from None


def refuse_programs(file: Path) -> None:
    """Raise BadInput for a database with computed content, which runs SQL of its own."""
    try:
        with closing(sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)) as base:
            programs = [name for (name,) in base.execute(PROGRAMS, ('CREATE VIRTUAL%',))]
            for table in ('messages', 'topics', 'schema', 'message_definitions'):
                for _, name, *_, kind in base.execute(f'PRAGMA table_xinfo({table})'):
                    programs += [name] if kind in COMPUTED else []
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
        raise _unreadable_error(file, error) from None
    if programs:
        raise BadInput(
            f"'{file}' has '{programs[0]}', a view, trigger or computed column, which no "
            'recording has; get it from a trusted source.'
        )


def refuse_unsafe_messages(file: Path) -> None:
    """Raise BadInput for a database with oversized messages."""
    try:
        with closing(sqlite3.connect(f'{file.absolute().as_uri()}?mode=ro', uri=True)) as base:
            for (head,) in base.execute('SELECT substr(data, 1, 18) FROM messages'):
                refuse_large_message(file, head)
            for (text,) in base.execute('SELECT DISTINCT offered_qos_profiles FROM topics'):
                parse_yaml(text or '', f"The QoS in '{file}'")
    except sqlite3.OperationalError as error:
        if QOS not in str(error):  # older bags have no QoS column
            raise _unreadable_error(file, error) from None
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
        raise _unreadable_error(file, error) from None


def _unreadable_error(file: Path, error: Exception) -> BadInput:
    return BadInput(
        f"'{file}' cannot be read ({error}); it is probably damaged, so copy it again."
    )


def refuse_large_message(file: Path, head: object) -> None:
    """Raise BadInput for a compressed message that is too large."""
    if isinstance(head, bytes) and head[:4] == zstandard.FRAME_HEADER:
        size = zstandard.frame_content_size(head)
        if size < 0 or size > CHUNK_BYTES:
            raise BadInput(
                f"'{file}' has a message that decompresses to more than {CHUNK_BYTES} bytes; "
                'copy the bag without the topic of that message (ros2 bag convert) and import '
                'the copy.'
            )
