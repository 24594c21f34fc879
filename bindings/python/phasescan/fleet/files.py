"""Files that appear whole or not at all."""
from __future__ import annotations

import hashlib
import json
import os
import pathlib
import tempfile
from typing import Any, Callable


def write_whole(path: pathlib.Path, write: Callable[[str], None]) -> None:
    """Calls ``write(name)`` for a file beside ``path``, then puts it in place."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    os.close(handle)
    try:
        write(name)
        os.chmod(name, 0o644)
        with open(name, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(name, path)
    except BaseException:
        if os.path.exists(name):
            os.unlink(name)
        raise


def write_text(path: pathlib.Path, text: str) -> None:
    """A text file, whole or not at all."""
    def write(name: str) -> None:
        pathlib.Path(name).write_text(text, encoding="utf-8")

    write_whole(path, write)


def write_json(path: pathlib.Path, value: Any) -> None:
    """JSON, whole or not at all."""
    write_text(path, json.dumps(value, indent=1) + "\n")


def read_json(path: pathlib.Path) -> Any:
    """What a JSON file holds; None where it is not there or broken."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def digest(value: Any) -> str:
    """By which values that are JSON are known again."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:32]
