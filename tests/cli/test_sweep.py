"""`duhamel sweep`: its progress, and the picture of its outputs."""

import re

import pytest
from duhamel.cli.app import app
from duhamel.cli.sweep import shown_cases
from duhamel.study import Case, Row
from typer.testing import CliRunner

SUMMARY = """case,m,status,seconds,peak,message
case-0001,1,done,0.5,2.0,
case-0002,2,done,0.5,4.0,
case-0003,3,failed,,,no convergence
"""


def row(reused=False):
    return Row(Case("a", {}, {}, None), "done", reused=reused)


def test_without_a_terminal_there_is_a_line_every_few_seconds(monkeypatch, capsys):
    monkeypatch.setattr("duhamel.files.progress.LINE_INTERVAL", 0.05)
    with shown_cases(4) as finished:
        finished(row())
        import time

        time.sleep(0.2)
    told = capsys.readouterr().err.splitlines()
    assert len(told) >= 2
    assert all(line.startswith("1 of 4 cases, 0:0") for line in told)


def test_an_interrupt_says_how_many_cases_are_kept():
    def interrupted():
        with shown_cases(4) as finished:
            finished(row())
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="interrupted: 1 of 4 cases are finished and kept"):
        interrupted()


def test_a_summary_is_drawn(tmp_path):
    (tmp_path / "summary.csv").write_text(SUMMARY)
    done = CliRunner().invoke(app, ["plot", str(tmp_path / "summary.csv")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "summary.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("text", "names", "message"),
    [
        (SUMMARY, ["speed"], "no output 'speed'; there are: seconds, peak"),
        (SUMMARY.replace("done", "open"), [], "no summary of a study: none of 3 cases is done"),
        ("a,b\n1,2\n", [], "no summary of a study: expected columns case, parameters, status"),
        ("", [], "no summary of a study: expected columns"),
        (SUMMARY.replace(",4.0,", ",four,"), [], "no summary of a study"),
        (re.sub(r"(case-\d+),\d", r"\1,1", SUMMARY), [], "expected parameters that vary"),
    ],
)
def test_what_is_no_summary_is_refused_in_one_line(tmp_path, text, names, message):
    (tmp_path / "summary.csv").write_text(text)
    done = CliRunner().invoke(app, ["plot", str(tmp_path / "summary.csv"), *names])
    assert done.exit_code == 1
    assert message in done.output
    assert len(done.output.splitlines()) == 1
