"""What a process can reach."""

import os
import socket
import subprocess
from pathlib import Path

import h5py


def tries(path, other, port):
    """What a process in the sandbox can read of its own file and of others, in Python and in HDF5."""

    def outcome(does):
        try:
            does()
        except Exception as error:
            return type(error).__name__
        return "done"

    def late():  # what is imported when it is first needed
        import colorsys
        import wave

        return colorsys, wave, "\u00e9".encode("utf-16"), "a".encode("cp1253")

    reached = {
        "own": lambda: Path(path).read_bytes(),
        "late": late,
        "other": lambda: Path(other, "bare").read_bytes(),
        "other HDF5": lambda: h5py.File(Path(other, "whole.h5")),
        "folder": lambda: os.listdir(other),
        "written": lambda: Path(path).write_bytes(b""),
        "new": lambda: Path(path).with_name("new").touch(),
        "removed": lambda: Path(path).unlink(),
        "system": lambda: Path("/etc/passwd").read_bytes(),
        "process": lambda: Path("/proc/self/environ").read_bytes(),
        "started": lambda: subprocess.run(["cat", str(Path(other, "bare"))], check=True, capture_output=True),
        "connected": lambda: socket.create_connection(("127.0.0.1", port), 5),
    }
    return {name: outcome(does) for name, does in reached.items()}, []
