"""Where the command `phasescan` is, for what runs it from Python."""
from __future__ import annotations

import os
import pathlib
import shutil
import sys


def find_command() -> str:
    """The command of this build: ``$PHASESCAN_COMMAND``, beside the package, in the build tree, or on ``$PATH``.

    Returns
    -------
    str

    Raises
    ------
    FileNotFoundError
    """
    package = pathlib.Path(__file__).resolve().parent
    asked = os.environ.get("PHASESCAN_COMMAND")
    places = [pathlib.Path(asked)] if asked else [package / "bin" / "phasescan", package.parent.parent / "bin" / "phasescan"]
    for place in places:
        if os.access(place, os.X_OK):
            return str(place)
    on_path = None if asked else shutil.which("phasescan", path=_path_without_this_script())
    if on_path is None:
        raise FileNotFoundError(f"the command phasescan is not at {' or '.join(map(str, places))} and not on PATH; "
                                "expected it there, or its place in $PHASESCAN_COMMAND")
    return on_path


def _path_without_this_script() -> str:
    """PATH without the folder of the script that pip makes: it would call itself."""
    own = pathlib.Path(sys.argv[0]).resolve().parent
    return os.pathsep.join(p for p in os.environ.get("PATH", "").split(os.pathsep) if p and pathlib.Path(p).resolve() != own)


def main() -> None:
    """Becomes the command, with this program's arguments."""
    try:
        command = find_command()
    except FileNotFoundError as error:
        sys.exit(f"phasescan: {error}")
    os.execv(command, [command, *sys.argv[1:]])
