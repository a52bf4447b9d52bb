"""Which files a bag is made of, and what its metadata.yaml tells."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_config.files import load_yaml

ADVICE = 'give a rosbag2 folder or an .mcap file'


def bag_files(path: Path) -> list[Path]:
    """
    Return the MCAP files of a bag in the order in which they were recorded.

    Parameters
    ----------
    path : Path
        A rosbag2 folder, or one .mcap file.

    Raises
    ------
    BadInput
        If there is no bag at `path`.

    """
    if path.is_file():
        return [path]
    if not path.exists():
        raise BadInput(f"'{path}' does not exist; {ADVICE}.")
    listed = listed_files(path, description(path))
    files = listed or sorted(path.glob('*.mcap'), key=natural)
    if files:
        return files
    if any(path.glob('*.db3')):
        raise BadInput(
            f"'{path}' is a bag in SQLite; convert it with `rosbags-convert --dst-storage mcap`."
        )
    raise BadInput(f"'{path}' holds no recording; {ADVICE}.")


def bag_in(folder: Path) -> Path:
    """Return the bag of a flight's results folder; any other path stands for itself."""
    inside = folder / 'bag'
    return inside if inside.is_dir() and not (folder / 'metadata.yaml').exists() else folder


def natural(path: Path) -> tuple[int, str]:
    """Return a key that sorts flight_2 before flight_10."""
    return len(path.name), path.name


def description(folder: Path) -> dict[str, object]:
    """Return `rosbag2_bagfile_information` of metadata.yaml; empty where there is none to use."""
    try:
        content = load_yaml(folder / 'metadata.yaml')
    except BadInput:  # the recording itself tells the same
        return {}
    found = content.get('rosbag2_bagfile_information') if isinstance(content, dict) else None
    return found if isinstance(found, dict) else {}


def listed_files(folder: Path, described: dict[str, object]) -> list[Path]:
    """Return the files that metadata.yaml lists, if it does and all of them are there."""
    names = described.get('relative_file_paths')
    if not isinstance(names, list):
        return []
    files = [folder / Path(str(name)).name for name in names]
    good = all(file.suffix == '.mcap' and file.is_file() for file in files)
    return files if good else []


def described_provenance(folder: Path) -> dict[str, str]:
    """Return the `custom_data` of metadata.yaml; empty where there is none."""
    found = description(folder).get('custom_data')
    if not isinstance(found, dict):
        return {}
    return {str(key): str(value) for key, value in found.items()}
