"""The command line as ``python -m asperity``."""

from asperity.cli import main

if __name__ == "__main__":
    main(prog_name="python -m asperity")
