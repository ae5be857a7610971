"""The program around its commands: exit codes, help, completion, and texts that survive any redirection."""

import importlib
import json
import re
import shlex
import warnings
from pathlib import Path

import pytest
from click.shell_completion import BashComplete

from asperity.case import PRESETS
from asperity.case.cases import read_case
from asperity.cli import main
from asperity.cli.commands import TEMPLATES
from asperity.errors import ComputationError
from asperity.studies.definition import load_study
from command_line import call, program

COMMANDS = sorted(main.commands)


def failing_with(monkeypatch, error):
    """Put a fault into the computation that no input makes, and warnings before it."""

    def run(case, progress=None):
        for _ in range(2):
            warnings.warn("finished work\nis not kept", RuntimeWarning, stacklevel=1)
        warnings.warn("of a library", DeprecationWarning, stacklevel=1)
        raise error

    monkeypatch.setattr(importlib.import_module("asperity.running"), "run", run)


@pytest.mark.parametrize(("error", "code", "kind", "message"), [
    (ComputationError("a", "b"), 3, "ComputationError", "a. Try: b."),
    (ZeroDivisionError("b\x1b"), 3, "ProgramError", "ZeroDivisionError: b\\x1b. Try: asperity --debug …,"),
    (MemoryError(), 3, "ProgramError", "are meant in? If so, try a smaller contact.window"),
    (KeyboardInterrupt(), 130, "ProgramError", "interrupted; run the same command again to continue"),
])  # fmt: skip
def test_failures_have_a_code_one_message_and_a_document(monkeypatch, error, code, kind, message):
    """Warnings before them are told once, each on a line of its own."""
    failing_with(monkeypatch, error)
    told = call("run", "small.toml", code=code).stderr
    warned = [line for line in told.splitlines() if "arning: " in line]
    assert warned == ["Warning: finished work\\nis not kept"]
    assert message in told.splitlines()[-1]
    assert "Traceback" not in told
    assert ("Traceback" in call("--debug", "run", "small.toml", code=code).stderr) == (code == 3)
    document = json.loads(call("run", "small.toml", "--json", code=code).stdout)
    assert (document["command"], document["exit_code"]) == ("run", code)
    assert document["error"]["kind"] == kind
    assert message in document["error"]["message"]


def test_an_interrupt_before_a_command_begins_is_130(monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(main, "make_context", interrupted)
    call(code=130)


def test_the_module_is_the_program():
    script = "import runpy; runpy.run_module('asperity', run_name='__main__')"
    wrong = program("new", "wheel-on-beam", script=script, code=2).stderr
    assert wrong.startswith("Error: kind: received 'wheel-on-beam'; allowed: \"ball-on-beam\", ")
    assert len(wrong.splitlines()) == 1
    assert "Usage: python -m asperity" in program("nwe", script=script, code=2).stderr


ENDING = """
import atexit, sys, threading
class Told:
    def __init__(self, name): self.name = name
    def __del__(self): print(self.name)
late = Told("taken apart")
from asperity.__main__ import start
def work():
    threading.main_thread().join()  # however long that takes: the program has nothing left to do
    atexit.register(print, "put away")
    print("awaited")
threading.Thread(target=work).start()
sys.stdout = open(sys.stdout.fileno(), "w", buffering=65536)
start()
"""


@pytest.mark.parametrize(("words", "code"), [(["--version"], 0), (["check", "nothing.toml"], 2)])
def test_the_program_puts_away_what_it_holds_and_ends_without_taking_python_apart(words, code):
    told = program(*words, script=ENDING, code=code).stdout.splitlines()
    assert told[-2:] == ["awaited", "put away"]
    assert "taken apart" not in told


@pytest.mark.parametrize(("encoding", "shown"), [
    ("cp1252", "-22.7 dB, 10-6 µm, delta = d0"),
    ("ascii", "-22.7 dB, 10-6 um, delta = d0"),
])  # fmt: skip
def test_a_pipe_without_a_minus_sign_gets_a_hyphen(encoding, shown):
    script = (
        "from asperity.cli import main\nfrom asperity.terminal import say\n"
        "main.command('tell')(lambda: say('−22.7 dB, 10⁻⁶ µm, δ = d₀'))\nmain(['tell'])"
    )
    told = program(script=script, PYTHONIOENCODING=encoding).stdout
    assert told.replace("\N{REPLACEMENT CHARACTER}", "µ").strip() == shown


# --- help and completion


@pytest.mark.parametrize("command", COMMANDS)
def test_help_teaches_with_examples_that_the_command_takes(command):
    """Each example is a line that the program can read: its command and its options are there."""
    told = call(command, "--help").stdout
    examples = told.split("Examples:\n")[1].splitlines()
    assert "<=" not in told  # ranges are in words
    assert [line[:4] == "  # " for line in examples] == [True, False] * (len(examples) // 2)
    for line in examples[1::2]:
        words = shlex.split(re.split(r" [|>]+ |\)\"", line.partition("asperity ")[2])[0])
        assert words[0] == command
        known = {name for option in main.commands[command].params for name in option.opts}
        assert {word for word in words if word.startswith("-")} <= known


def test_help_lists_every_command_with_a_whole_sentence():
    told = call("--help").stdout
    for name, command in main.commands.items():
        assert re.search(rf"^  {name} +{re.escape(command.short_help)}$", told, re.M)
    assert "..." not in told.split("Begin:")[1]


WHAT_HELPS = ("what-helps", "what-helps-in-bearings", "what-helps-in-roller-bearings")


@pytest.mark.parametrize(
    ("words", "completions"),
    [
        ("new ", {*PRESETS, *TEMPLATES}),
        ("new w", {"wheel-on-rail", *WHAT_HELPS}),
        ("new --law sh", {"shifted", "shifted-unfiltered"}),
        ("run --device ", {"cpu", "gpu"}),
        ("com", {"compare", "completion"}),
    ],
)
def test_a_shell_completes(words, completions):
    *before, begun = words.split(" ")
    found = BashComplete(main, {}, "asperity", "_ASPERITY_COMPLETE").get_completions(before, begun)
    assert {each.value for each in found} == completions


def test_a_shell_is_told_how_to_complete():
    assert all("_ASPERITY_COMPLETE" in call("completion", shell).stdout for shell in ("bash", "zsh", "fish"))


def test_what_a_shell_asks_is_answered():
    asked = {"_ASPERITY_COMPLETE": "bash_complete", "COMP_WORDS": "asperity new w", "COMP_CWORD": "2"}
    assert program(**asked).stdout.split() == [f"plain,{name}" for name in ("wheel-on-rail", *WHAT_HELPS)]


# --- new


@pytest.mark.parametrize("name", ["ball-on-beam", "wheel-on-rail", "study"])
def test_what_is_new_is_valid_and_survives_any_encoding_of_a_redirection(name):
    """PowerShell 5 writes UTF-16, cmd its code page."""
    text = call("new", name).stdout
    assert text.isascii()
    Path("case.toml").write_text(call("new", "ball-on-beam").stdout)
    for encoding in ("ascii", "utf-16"):
        Path("new.toml").write_bytes(text.encode(encoding))
        if name == "study":
            assert load_study("new.toml").shape == (2, 3)
        else:
            assert read_case("new.toml").kind == name


def test_laws_of_a_new_case_can_be_chosen():
    Path("chosen.toml").write_text(call("new", "ball-on-beam", "--law", "table", "--law", "hertz").stdout)
    assert read_case("chosen.toml").laws == ("table", "hertz")


def test_no_case_is_begun_with_a_law_that_its_kind_cannot_have():
    refused = call("new", "roller-bearing", "--law", "hertz", code=2)
    assert 'a roller-bearing case: 1 error\n  - laws: received hertz; allowed: "areal".' in refused.stderr
    assert refused.stdout == ""
    assert 'laws = ["areal"]' in call("new", "roller-bearing", "--law", "areal").stdout
