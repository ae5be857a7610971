"""The command line. Its help imports nothing heavy: every command imports what it needs when it runs."""

from asperity.cli import begin, compute, look
from asperity.cli.program import main

__all__ = ["begin", "compute", "look", "main"]
