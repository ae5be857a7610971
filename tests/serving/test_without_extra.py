"""Without the extra, and with a folder or a port that cannot be used, the command says what to do."""

import importlib.util
import socket

import pytest
from click.testing import CliRunner

from asperity.cli import main


def asked(*words):
    found = CliRunner().invoke(main, ["serve", *words])
    return found.exit_code, found.output


def test_without_the_extra_it_says_what_to_install(tmp_path, monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "uvicorn" else found(name, *more)
    )
    code, told = asked("-o", str(tmp_path / "page"))
    assert code == 2
    assert 'no uvicorn; allowed: the extra app. Install them: python -m pip install "asperity[app]".' in told
    assert not (tmp_path / "page").exists()


def test_a_port_that_is_taken_is_said(tmp_path):
    pytest.importorskip("uvicorn", reason="the extra app is not installed")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        code, told = asked("-o", str(tmp_path), "--port", str(taken.getsockname()[1]))
    assert code == 2
    assert "allowed: a free port of this machine. Choose another one with --port" in told


@pytest.mark.parametrize("port", ["-1", "70000"])
def test_a_port_that_is_none_is_said(tmp_path, port):
    pytest.importorskip("uvicorn", reason="the extra app is not installed")
    code, told = asked("-o", str(tmp_path), "--port", port)
    assert code == 2
    assert f"port: received {port}" in told


def test_a_folder_that_is_a_file_is_said(tmp_path):
    pytest.importorskip("uvicorn", reason="the extra app is not installed")
    (tmp_path / "page").write_text("x")
    code, told = asked("-o", str(tmp_path / "page"))
    assert code == 2
    assert "Choose another folder with -o." in told
