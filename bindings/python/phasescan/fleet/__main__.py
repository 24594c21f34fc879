"""``python3 -m phasescan.fleet``."""
import sys

from .cli import main

sys.exit(main())
