"""``spheredrive view``: what it says, and what it refuses."""

import re
import sys

import pytest

from spheredrive.app import command
from spheredrive.designs import design_path
from spheredrive.errors import InputError, SpheredriveError

pytest.importorskip("viser")
DESIGN = design_path("orthogonal")


def interrupted(*_):
    raise KeyboardInterrupt


def test_view_says_where_the_page_is_and_ends_when_it_is_interrupted(capsys, monkeypatch):
    monkeypatch.setattr(command.time, "sleep", interrupted)
    monkeypatch.setattr(command, "_opened", lambda url: False)
    assert command.view(DESIGN) == 0
    said = capsys.readouterr()
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/\n", said.out)
    assert "Ctrl-C" in said.err and "No browser was found" in said.err


def test_view_on_another_address_takes_a_token_that_is_new_each_time(capsys, monkeypatch):
    asked = []
    real = command.start_server

    def here(address, port, token):
        asked.append((address, token))
        return real("127.0.0.1", port, token)

    monkeypatch.setattr(command, "start_server", here)
    monkeypatch.setattr(command.time, "sleep", interrupted)
    for _ in range(2):
        command.view(DESIGN, browser=False, address="10.1.2.3")
    urls = capsys.readouterr().out.split()
    tokens = [token for _, token in asked]
    assert len(set(tokens)) == 2 and min(map(len, tokens)) >= 32
    assert all(re.fullmatch(rf"http://10\.1\.2\.3:\d+/\?token={token}", url) for url, token in zip(urls, tokens, strict=True))


def test_open_page_refuses_files_before_it_serves_anything(tmp_path, monkeypatch):
    monkeypatch.setattr(command, "start_server", interrupted)
    with pytest.raises(InputError, match="no such file"):
        command.open_page(tmp_path / "none.toml")
    (tmp_path / "run.nc").write_text("no run")
    with pytest.raises(InputError, match="not a NetCDF-4 file"):
        command.open_page(DESIGN, tmp_path / "run.nc")


def test_open_page_without_viser_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(SpheredriveError, match=r'pip install "spheredrive\[app\]"'):
        command.open_page(DESIGN)
