# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find the files of a bag and read its metadata.yaml."""

from pathlib import Path
from typing import Final

from lta_config.errors import BadInput
from lta_config.files import load_yaml

ADVICE = 'give a rosbag2 folder or an .mcap file'
MOST_ABSENT = 20  # missing files that are listed
IN_SQLITE: Final = 'a bag in SQLite format (.db3); convert it to MCAP with `lta import`'
PACKED_ADVICE: Final = 'compressed with zstd; decompress it with `zstd -d` first'
# First bytes of files in other formats
OTHER_FORMATS: Final = {
    b'SQLite format 3\0': IN_SQLITE,
    b'#ROSBAG V': 'a ROS 1 bag; convert it with `lta import`',
    b'ULog\x01\x12\x35': 'a PX4 log; convert it with `lta import`',
    b'\x28\xb5\x2f\xfd': PACKED_ADVICE,
}


def find_bag_files(path: Path, described: dict[str, object] | None = None) -> list[Path]:
    """
    Return the MCAP files of a bag in the order of recording.

    `path` is a rosbag2 folder or one .mcap file; `described` is the folder's `read_metadata`, if
    it has been read.

    Raise `BadInput` if there is no bag at `path`.
    """
    if path.is_file():
        return [path]
    if not path.exists():
        raise BadInput(f"'{path}' does not exist; {ADVICE}.")
    listed = find_listed_files(path, read_metadata(path) if described is None else described)
    files = listed or sorted(filter(Path.is_file, path.glob('*.mcap')), key=natural_sort_key)
    if files:
        return files
    if any(path.glob('*.db3')):
        raise BadInput(f"'{path}' is {IN_SQLITE}.")
    if any(path.glob('*.mcap.zst*')):
        raise BadInput(f"'{path}' is {PACKED_ADVICE}.")
    raise BadInput(f"'{path}' contains no .mcap file; {ADVICE}.")


def wrong_format_error(file: Path, head: bytes) -> BadInput:
    """Return the error for a file that is not MCAP, with its actual format if known."""
    if not head:
        return BadInput(f"'{file}' is empty (0 bytes): nothing was recorded. Record it again.")
    for magic, description in OTHER_FORMATS.items():
        if head.startswith(magic):
            return BadInput(f"'{file}' is {description}.")
    return BadInput(
        f"'{file}' is not an MCAP recording; {ADVICE}, or convert a log with `lta import`."
    )


def find_bag(folder: Path) -> Path:
    """Return the bag of a flight's results folder; any other path is returned unchanged."""
    inside = folder / 'bag'
    return inside if inside.is_dir() and not (folder / 'metadata.yaml').exists() else folder


def find_newest_bag(runs: Path = Path('runs')) -> Path:
    """
    Return the bag of `runs` that was completed last, by the time of its metadata.yaml.

    `runs`: a folder of results folders and bags, as commands of LTA make in the current folder.

    Raise `BadInput` if it has none.
    """
    recorded = [
        (file.stat().st_mtime_ns, file.parent)
        for folder in runs.glob('*/')
        # An .mcap file alone may be drawn, as the animation of `lta discover` is
        if (file := find_bag(folder) / 'metadata.yaml').exists()
    ]
    if not recorded:
        raise BadInput(
            f"There is no recording in '{runs.absolute()}'; fly first, as with 'lta simulate', or "
            'give the folder of a bag.'
        )
    return max(recorded)[1]


def natural_sort_key(path: Path) -> tuple[int, str]:
    """Return a key that sorts flight_2 before flight_10."""
    return len(path.name), path.name


def read_metadata(folder: Path) -> dict[str, object]:
    """Return `rosbag2_bagfile_information` of metadata.yaml; empty if unusable."""
    try:
        content = load_yaml(folder / 'metadata.yaml')
    except BadInput:  # the MCAP file contains the same information
        return {}
    metadata = content.get('rosbag2_bagfile_information') if isinstance(content, dict) else None
    return metadata if isinstance(metadata, dict) else {}


def find_listed_files(folder: Path, described: dict[str, object]) -> list[Path]:
    """Return the files that metadata.yaml lists, if all of them exist."""
    names = described.get('relative_file_paths')
    if not isinstance(names, list):
        return []
    # Only the file name: metadata.yaml must not lead outside the folder.
    files = [folder / Path(str(name)).name for name in names]
    good = all(
        # Names of 256 bytes or more make is_file raise OSError on Linux
        file.suffix == '.mcap' and len(file.name) < 256 and file.is_file()
        for file in files
    )
    return files if good else []


def find_message_compression(described: dict[str, object]) -> str:
    """Return the compression of single messages; empty if there is none."""
    mode = str(described.get('compression_mode') or '').lower()
    return str(described.get('compression_format') or '') if mode == 'message' else ''


def describe_absent_files(folder: Path, described: dict[str, object]) -> list[str]:
    """Return a sentence for each file that metadata.yaml lists but is missing."""
    names = described.get('relative_file_paths')
    inside = [Path(str(name)).name for name in names] if isinstance(names, list) else []
    return [
        f"metadata.yaml lists the file '{name}', which is missing from the bag's folder."
        for name in inside
        if 0 < len(name) < 256 and '\0' not in name and not (folder / name).is_file()
    ][:MOST_ABSENT]


def extract_provenance(described: dict[str, object]) -> dict[str, str]:
    """Return the `custom_data` of `rosbag2_bagfile_information`; empty if there is none."""
    custom_data = described.get('custom_data')
    if not isinstance(custom_data, dict):
        return {}
    return {str(key): str(value) for key, value in custom_data.items()}
