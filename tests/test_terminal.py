"""One place writes to the terminal: names are shown as text, and nobody has to listen."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from asperity.errors import printable
from asperity.terminal import say, say_table
from package_source import MODULES, nodes_of

CASE = 'kind = "ball-on-beam"\nduration = "0.01 s"\nlaws = ["hertz"]\n[surface]\nspectrum = "iso3095"\n'
WRITERS = {
    "terminal.py",
    "progress.py",  # bars; its words go through `printable`
    "sandbox.py",  # answers to the process that asked
    "worker_processes.py",
    "__main__.py",  # before anything can be imported
}
posix = pytest.mark.skipif(sys.platform == "win32", reason="streams are closed otherwise there")
full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")


def test_nothing_else_writes_to_the_terminal():
    for module in MODULES:
        if module.name in WRITERS:
            continue
        for node in nodes_of(module):
            name = getattr(node, "id", getattr(node, "attr", ""))
            assert name not in {"print", "echo", "secho", "stdout", "stderr", "Console"}, f"{module}: {name}"
            if isinstance(node, ast.Import) and module.name != "text_files.py":
                assert "csv" not in [alias.name for alias in node.names], module


@pytest.mark.parametrize(("text", "shown"), [
    ("map [um] v2 – höhe, 粗さ.npy", "map [um] v2 – höhe, 粗さ.npy"),
    ("a\N{NO-BREAK SPACE}b", "a\N{NO-BREAK SPACE}b"),
    ("\x1b[31mred", "\\x1b[31mred"),
    ("\x9b31m", "\\x9b31m"),  # the same in one character
    ("a\x07\x08\r\x7f", "a\\x07\\x08\\r\\x7f"),
    ("beam\u202excod.exe", "beam\\u202excod.exe"),
    ("\u2066a\u2069\u200f", "\\u2066a\\u2069\\u200f"),
    ("a\u2028b", "a\\u2028b"),
    ("a\ud800b", "a\\ud800b"),
    ("\udcff.toml", "\\xff.toml"),  # how Python carries a byte of a file name that is no UTF-8
    ("a\nb\tc", "a\\nb\\tc"),
])  # fmt: skip
def test_what_would_act_is_spelled_out(text, shown):
    assert printable(text) == shown
    assert printable(shown) == shown
    printable(text).encode("utf-8")


def test_line_ends_and_tabs_may_stay(capsys):
    assert printable("a\n\tb\r\x1b", lines=True) == "a\n\tb\\r\\x1b"
    say("\x1b]0;owned\x07\nError: none", err=True)
    say("first\n\tsecond\x9b1m", lines=True)
    printed = capsys.readouterr()
    assert printed.err == "\\x1b]0;owned\\x07\\nError: none\n"
    assert printed.out == "first\n\tsecond\\x9b1m\n"


@pytest.mark.parametrize("name", ["map [um] v2.npy", "a [/b]", "[red]x", ":smile: [link=x]y", "a\x1b[2Jb"])
def test_names_in_tables_are_text(capsys, name):
    say_table(name, [name], [[name]], width=60)
    printed = capsys.readouterr().out
    assert printed.count(name.replace("\x1b", "\\x1b")) == 3
    assert "\x1b" not in printed


def test_tables_stand_on_standard_output_in_a_notebook(capsys, monkeypatch):
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    say_table("work", ["law"], [["areal"]], width=60)
    assert "│ areal │" in capsys.readouterr().out


# --- the program, whoever reads what it says


@pytest.fixture(scope="module", autouse=True)
def one_cache(cache_of_module):
    """A case is computed by the first command that checks it, which has all streams closed."""


def run(command, folder, code=0):
    """What a command line of a shell, with ``asperity`` for the program, says on standard error."""
    environment = os.environ | {"PYTHONIOENCODING": "utf-8"}
    (folder / "case.toml").write_text(CASE)
    done = subprocess.run(
        ["bash", "-c", command.replace("asperity", f"'{sys.executable}' -m asperity", 1)],
        cwd=folder, env=environment, capture_output=True, timeout=300,
    )  # fmt: skip
    assert done.returncode == code, done
    return done.stderr.decode()


@posix
@pytest.mark.parametrize("closed", ["<&- >&- 2>&-", ">&-"])
def test_closed_streams_are_no_failure(tmp_path, closed):
    run(f"asperity check case.toml {closed}", tmp_path)
    run(f"asperity check absent.toml {closed}", tmp_path, code=2)


@posix
def test_a_reader_that_ends_is_no_failure(tmp_path):
    assert "Error" not in run("asperity check case.toml | true; exit ${PIPESTATUS[0]}", tmp_path)
    run("asperity --help 2>&1 | head -c 1; exit ${PIPESTATUS[0]}", tmp_path)


@posix
def test_no_file_takes_the_number_of_a_closed_stream(tmp_path):
    code = (
        "import os, sys; from asperity.terminal import standard_streams\n"
        "with standard_streams():\n"
        "    opened = os.open('data', os.O_CREAT | os.O_WRONLY)\n"
        "    print('text'); os.write(1, b'text'); os.write(2, b'text')\n"
        "    raise SystemExit(0 if opened > 2 and os.path.getsize('data') == 0 else 1)"
    )
    (tmp_path / "code.py").write_text(code)
    run(f"'{sys.executable}' code.py <&- >&- 2>&-", tmp_path)


@full
@pytest.mark.parametrize(
    "words", ["new ball-on-beam", "check absent.toml --json", "--help", "wheel --help", "--version"]
)
def test_standard_output_on_a_full_disk_is_a_failure(tmp_path, words):
    """Of a document too, whether the command has done its work, failed, or was called wrongly."""
    told = run(f"asperity {words} > /dev/full", tmp_path, code=3)
    assert "Error: standard output could not be written (" in told
    assert "Traceback" not in told


@full
def test_standard_error_on_a_full_disk_changes_no_code(tmp_path):
    run("asperity check absent.toml 2> /dev/full", tmp_path, code=2)


@posix
@pytest.mark.parametrize("words", [r"check $'\xff.toml'", r"$'\e[31mrun'", r"run a b $'\e]0;x'"])
def test_names_of_files_and_commands_are_spelled_out(tmp_path, words):
    told = run(f"asperity {words}", tmp_path, code=2)  # and all of it is UTF-8
    assert "\x1b" not in told
    assert "xff" not in words or "\\xff.toml: received no such file" in told
