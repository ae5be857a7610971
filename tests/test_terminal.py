"""One place writes to the terminal: names are shown as text, and nobody has to listen."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import asperity
from asperity.cli import main
from asperity.terminal import say, say_table

SOURCE = Path(asperity.__file__).parent
CASE = 'kind = "ball-on-beam"\nduration = "0.01 s"\nlaws = ["hertz"]\n[surface]\nspectrum = "iso3095"\n'
WRITERS = {
    "terminal.py",
    "progress.py",  # bars; its words go through `printable`
    "sandbox.py",  # answers to the process that asked
    "desk.py",
    "__main__.py",  # before anything can be imported
}

posix = pytest.mark.skipif(sys.platform == "win32", reason="streams are closed otherwise there")


def test_nothing_else_writes_to_the_terminal():
    for module in sorted(SOURCE.rglob("*.py")):
        if module.name in WRITERS:
            continue
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
            name = getattr(node, "id", getattr(node, "attr", ""))
            assert name not in {"print", "echo", "secho", "stdout", "stderr", "Console"}, f"{module}: {name}"
            if isinstance(node, ast.Import) and module.name != "text_files.py":
                assert "csv" not in [alias.name for alias in node.names], module


def test_what_controls_a_terminal_is_spelled_out(capsys):
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


def run(command, folder, **options):
    """Run a command line of a shell, with ``asperity`` for the program; returns its exit code and outputs."""
    program = f"'{sys.executable}' -m asperity"
    environment = os.environ | {"ASPERITY_CACHE": str(folder / "cache"), "PYTHONIOENCODING": "utf-8"}
    (folder / "case.toml").write_text(CASE)
    return subprocess.run(
        ["bash", "-c", command.replace("asperity", program)],
        cwd=folder, env=environment, capture_output=True, timeout=300, check=False, **options,
    )  # fmt: skip


@posix
@pytest.mark.parametrize("command", ["check case.toml", "new wheel-on-rail", "--help", "surface --help"])
def test_a_reader_that_ends_is_no_failure(tmp_path, command):
    done = run(f"asperity {command} | true; exit ${{PIPESTATUS[0]}}", tmp_path)
    assert done.returncode == 0
    assert b"Error" not in done.stderr
    done = run(f"asperity {command} 2>&1 | head -c 1; exit ${{PIPESTATUS[0]}}", tmp_path)
    assert done.returncode == 0


@posix
@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_closed_streams_are_no_failure(tmp_path, closed):
    assert run(f"asperity check case.toml {closed}", tmp_path).returncode == 0
    assert run(f"asperity check absent.toml {closed}", tmp_path).returncode == 2


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
    done = run(f"'{sys.executable}' code.py <&- >&- 2>&-", tmp_path)
    assert done.returncode == 0


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_standard_output_on_a_full_disk_is_a_failure(tmp_path):
    done = run("asperity new ball-on-beam > /dev/full", tmp_path)
    assert done.returncode == 3
    assert done.stderr.decode().startswith("Error: standard output could not be written (")
    assert run("asperity check absent.toml 2> /dev/full", tmp_path).returncode == 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("words", ["cache", "check absent.toml", "check"])
def test_a_document_on_a_full_disk_is_a_failure(tmp_path, words):
    """Whether the command has done its work, failed, or was called wrongly."""
    done = run(f"asperity {words} --json > /dev/full", tmp_path)
    assert done.returncode == 3
    assert "Error: standard output could not be written (" in done.stderr.decode()
    assert "Traceback" not in done.stderr.decode()


@posix
def test_names_of_files_and_commands_are_spelled_out(tmp_path):
    escape = b"\x1b"
    for arguments in (r"check $'\e[31m.toml'", r"check $'\xff.toml'", r"$'\e[31mrun'", r"run a b $'\e]0;x'"):
        done = run(f"asperity {arguments}", tmp_path)
        assert done.returncode == 2, done
        assert escape not in done.stderr
        assert done.stderr.decode()  # and all of it is UTF-8
    assert b"\\xff.toml: received no such file" in run(r"asperity check $'\xff.toml'", tmp_path).stderr


def test_an_interrupt_before_a_command_begins_is_130(monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(main, "make_context", interrupted)
    with pytest.raises(SystemExit) as caught:
        main([])
    assert caught.value.code == 130
