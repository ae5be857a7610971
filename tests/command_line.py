"""The command line as tests call it, in this process or as a program of its own, and small cases for it."""

import html
import os
import re
import subprocess
import sys
from contextlib import chdir, contextmanager

import numpy as np
import pytest
from click.testing import CliRunner

from asperity.cli import main

CASE = 'kind = "ball-on-beam"\nduration = "0.01 s"\n[surface]\nrms = "0.5 um"\n'
SMALL = """
kind = "ball-on-beam"
laws = ["hertz", "linear"]
start = "0.45 m"
duration = "20 ms"
settling = "0 s"
[surface]
spectrum = "iso3095"
"""
"""A case of a second: smooth bodies follow a line."""
RAIL = 'kind = "wheel-on-rail"\nduration = "0.2 s"\nsettling = "0.1 s"\n[surface]\nspectrum = "iso3095"\n'
RAIL += '[contact]\nsamples = 2\n[wheel]\nsection = "rigid"\n'
PROGRAM = "from asperity.__main__ import start; start()"
NOISE = np.random.default_rng(0)


@contextmanager
def working_in(folder):
    """Work in a folder, with a cache of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("ASPERITY_CACHE", str(folder / "cache"))
        yield folder


def call(*words, code=0):
    """What the program says in this process, with this exit code."""
    outcome = CliRunner().invoke(main, list(words))
    assert outcome.exit_code == code, outcome.output
    return outcome


def program(*words, code=0, script=PROGRAM, **environment):
    """What the program says as a process of its own, with this exit code."""
    done = subprocess.run(
        [sys.executable, "-c", script, *words], capture_output=True, encoding="utf-8", errors="replace",
        env={**os.environ, "PYTHONIOENCODING": "utf-8", **environment},
    )  # fmt: skip
    assert done.returncode == code, done.stderr
    return done


def made_again(page, folder, *words):
    """Save the files that a page shows under Make it again, and call its command, with further words."""
    before, _, told = page.read_text("utf-8").partition('<h2 id="remake">')
    assert '<a href="#remake">Make it again</a>' in before  # among the contents
    command, *texts = map(html.unescape, re.findall(r"<pre[^>]*>(.*?)</pre>", told, re.DOTALL))
    folder.mkdir()
    for name, text in zip(re.findall(r"<code>(.*?)</code>", told), texts, strict=True):
        (folder / name).write_text(text, "utf-8")
    program, *rest = command.split()
    assert program == "asperity"
    with chdir(folder):
        return call(*rest, *words)


def words_of(said):
    """All words of a text, of tables too, on one line."""
    return " ".join(said.replace("│", " ").split())
