"""Which logs: a text file with a path, a glob or a folder a line."""
from __future__ import annotations

import dataclasses
import pathlib
import re


class ManifestError(ValueError):
    """A manifest that cannot be read: "FILE:LINE: what is wrong and what was expected"."""


@dataclasses.dataclass(frozen=True)
class Log:
    """A log of the fleet: its number in the manifest's order, from 1; as it is named; where it is."""

    number: int
    name: str
    path: str

    @property
    def folder(self) -> str:
        """The folder of its results, below DIR."""
        return f"logs/{self.number:06d}-{re.sub('[^A-Za-z0-9._-]+', '-', pathlib.PurePath(self.path).name)[:60]}"


def read_manifest(path: str) -> list[Log]:
    """The logs of a manifest, each once, in its order; those of a glob or a folder by name.

    A name without a match stays, and is a broken log in the end: nothing is lost without a word. Names are relative to the manifest's
    folder.

    Raises
    ------
    ManifestError
    """
    try:
        text = pathlib.Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise ManifestError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ManifestError(f"{path}: is no text; expected a path, a glob or a folder a line") from None
    base = pathlib.Path(path).resolve().parent
    names: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), 1):
        name = line.strip()
        if not name or name.startswith("#"):
            continue
        if "\0" in name:
            raise ManifestError(f"{path}:{number}: is no path; expected a path, a glob or a folder")
        for found in _expand(base, name):
            names.setdefault(found[1], found[0])
    if not names:
        raise ManifestError(f"{path}: names no log; expected a path, a glob or a folder a line")
    return [Log(number, name, where) for number, (where, name) in enumerate(names.items(), 1)]


def _expand(base: pathlib.Path, name: str) -> list[tuple[str, str]]:
    """(as it is named, where it is) of each log that a line means."""
    place = base / name
    if place.is_dir() and not _is_recording(place):
        found = sorted(p for p in place.rglob("*") if _is_log(p))
    elif any(c in name for c in "*?[") and not place.exists():
        anchor, pattern = (pathlib.Path("/"), name.lstrip("/")) if name.startswith("/") else (base, name)
        found = sorted(p for p in anchor.glob(pattern) if p.is_file() or _is_recording(p))
    else:
        found = [place]
    if not found:
        return [(name, str(place))]
    names = [str(p.relative_to(base)) if p.is_relative_to(base) else str(p) for p in found]
    return [(n, str(p)) for n, p in zip(names, found)]


def _is_recording(place: pathlib.Path) -> bool:
    """A folder that is one log: a ROS 2 bag."""
    return place.is_dir() and (place / "metadata.yaml").is_file()


def _is_log(place: pathlib.Path) -> bool:
    """What is taken from a folder: files, but for what `phasescan simulate` writes beside them, hidden ones, and parts of a bag."""
    if _is_recording(place):
        return True
    return (place.is_file() and not place.name.startswith(".") and not place.name.endswith((".truth.tum", ".md", ".txt", ".yaml", ".json", ".png", ".html"))
            and not _is_recording(place.parent))
