"""The command itself, as a process: exit codes, messages, help."""

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner

from pipeline.cli import kouros as cli
from pipeline.cli.commands import ALL
from tests.museum import ROWS, kouros, own_site, workspace

pytestmark = pytest.mark.slow_file


def test_every_command_has_help_with_an_example() -> None:
    for command in ALL:
        done = CliRunner().invoke(cli, [str(command.name), "--help"])
        assert done.exit_code == 0, command.name
        assert f"Example: kouros {command.name}" in done.output, command.name


def test_a_night_from_nothing(tmp_path: Path) -> None:
    """init, import, check, run, report, diff: what a new user does, with the exit codes of the contract."""
    assert kouros("init", folder=tmp_path).returncode == 0
    again = kouros("init", folder=tmp_path)
    assert again.returncode == 2
    assert "is there already" in again.stderr
    settings = workspace(tmp_path)
    dry = kouros("import", "export.csv", "--dry-run", folder=tmp_path)
    assert "3 rows, 3 objects, 0 rejected" in dry.stdout
    assert "nothing was written" in dry.stdout
    empty = kouros("run", "--object", "1", folder=settings.home)
    # The source is read before every run, so that object 1 is there although nothing was imported by hand.
    assert empty.returncode == 0
    done = kouros("run", "-q", folder=tmp_path)
    assert done.returncode == 0  # object 3 has no size, which is no fault of the night
    assert "      1  cannot be assessed" in done.stdout
    assert done.stderr == ""
    report = done.stdout.strip().splitlines()[-1].removeprefix("Report: ")
    assert Path(report).is_file()
    checked = kouros("check", "--json", folder=tmp_path)
    assert checked.returncode == 0
    states = {d["what"]: d["state"] for d in json.loads(checked.stdout)}
    assert set(states.values()) <= {"ok", "warning"}
    assert states["motions"] == "warning"  # nobody has approved the bundled record
    assert kouros("report", folder=tmp_path).stdout.startswith("Report: ")
    once = kouros("diff", folder=tmp_path)
    assert (once.returncode, "there is 1 finished run of the whole collection" in once.stderr) == (2, True)
    machine = kouros("run", "--quiet", "--strict", "--json", folder=tmp_path)
    assert (machine.returncode, machine.stderr) == (3, "")
    assert json.loads(machine.stdout)["objects"] == 3
    assert json.loads(machine.stdout)["exit_code"] == 3
    assert "nothing changed" in kouros("diff", folder=tmp_path).stdout


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["run", "--gallery", "Nowhere"], 2, "there is no gallery 'Nowhere' in the inventory"),
        (["run", "--fidelity", "magic"], 2, "Invalid value for '--fidelity'"),
        (["nonsense"], 2, "No such command 'nonsense'"),
        (["import", "absent.csv"], 5, "absent.csv"),
        (["import", "export.csv", "--mapping", "absent.toml"], 2, "absent.toml"),
        (["run", "--site", "absent"], 4, "absent"),
        (["respond", "slidin", "friction_static=0.1"], 2, "did you mean 'sliding'"),
        (["respond", "sliding", "friction=0.1"], 2, "has no parameter 'friction'"),
        (["respond", "sliding", "friction_static=-1"], 2, "friction_static must be a finite number at least 0"),
        (["respond", "sliding", "friction_static=much"], 2, "friction_static: 'much' is not a number"),
        (["respond", "sliding", "friction_static"], 2, "is not NAME=VALUE"),
        (["--config", "other.toml", "run"], 2, "other.toml: there is no such file"),
        (["report", "no-such-run"], 2, "no-such-run"),
    ],
)
def test_errors_are_said_without_a_traceback(tmp_path: Path, words: list[str], code: int, message: str) -> None:
    workspace(tmp_path)
    done = kouros(*words, folder=tmp_path)
    assert done.returncode == code, done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_a_mapping_that_names_a_column_that_is_not_there(tmp_path: Path) -> None:
    workspace(tmp_path)
    mapping = tmp_path / "mapping.toml"
    mapping.write_text(mapping.read_text(encoding="utf-8").replace('"height_m"', '"hight_m"'), encoding="utf-8")
    done = kouros("import", "export.csv", folder=tmp_path)
    assert done.returncode == 2
    assert all(word in done.stderr for word in ("mapping.toml", "height_m", "hight_m", "gallery"))


def test_an_empty_collection(tmp_path: Path) -> None:
    workspace(tmp_path, rows=[])
    done = kouros("run", folder=tmp_path)
    assert done.returncode == 5
    assert "empty collection" in done.stderr


def test_a_truncated_record(tmp_path: Path) -> None:
    """A record cut short and a manifest that agrees with it: the reader itself must refuse."""
    site = own_site(tmp_path)
    workspace(tmp_path, site="site")
    record = site / "CI.CLC..HNN.mseed"
    whole = record.read_bytes()
    record.write_bytes(whole[: len(whole) // 2 + 7])
    done = kouros("run", folder=tmp_path)
    assert done.returncode == 4
    assert "CI.CLC..HNN.mseed" in done.stderr
    assert [path.name for path in sorted((tmp_path / "reports").iterdir())] == ["index.html", "status.json"]


def test_a_shrunken_source(tmp_path: Path) -> None:
    workspace(tmp_path)
    assert kouros("import", "export.csv", folder=tmp_path).returncode == 0
    workspace(tmp_path, rows=ROWS[:1])
    done = kouros("import", "export.csv", folder=tmp_path)
    assert done.returncode == 7
    assert kouros("import", "export.csv", "--shrink-limit", "0.9", folder=tmp_path).returncode == 0


def test_debug_shows_the_traceback(tmp_path: Path) -> None:
    assert "Traceback" in kouros("--debug", "run", folder=tmp_path).stderr


def lines(text: str) -> Sequence[str]:
    return [line for line in text.splitlines() if line]


def test_models_and_respond_for_programs(tmp_path: Path) -> None:
    rows = json.loads(kouros("models", "--json", folder=tmp_path).stdout)
    assert {"rocking", "standing", "sliding", "stress", "flexible_stress", "swing", "swing_3d", "friction_isolator",
            "horizontal_isolator", "rotational_isolator", "oscillator", "unhooking",
            "hanger_load", "unanchored"} == {row["name"] for row in rows}  # fmt: skip
    done = kouros("respond", "sliding", "friction_static=0.05,0.1", "--json", folder=tmp_path)
    slides = [row["displacement"] for row in json.loads(done.stdout)]
    assert slides[0] > slides[1] > 0.0
    assert len(lines(kouros("respond", "rocking", "half_width=0.1", "cg_height=0.5", "--angle", "worst",
                            folder=tmp_path).stdout)) == 2  # fmt: skip
    bound = kouros("respond", "sliding", "friction_static=0.05,5", "--fidelity", "bound", "--json", folder=tmp_path)
    assert [row["high"] == 0.0 for row in json.loads(bound.stdout)] == [False, True]


@pytest.mark.parametrize("place", [0, 1], ids=["before the verb", "after it"])
def test_how_much_is_said_may_be_told_before_the_verb_or_after_it(place: int, tmp_path: Path) -> None:
    def said(option: str, *words: str) -> subprocess.CompletedProcess[str]:
        return kouros(*words[:place], option, *words[place:], folder=tmp_path)

    traced = said("--debug", "report")
    assert "Traceback" in traced.stderr
    logged = said("--log-json", "report")
    assert json.loads(logged.stderr)["event"] == "error"
    for option, words in (("-q", "models"), ("--quiet", "init"), ("-v", "init"), ("--verbose", "models")):
        done = said(option, words, *(("--dry-run",) if words == "init" else ()))
        assert done.returncode == 0, done.stderr
    # Of verbs of verbs too.
    assert said("-q", "motions", "list", "--help").returncode == 0


def test_the_examples_of_a_verb_stand_on_lines_of_their_own(tmp_path: Path) -> None:
    for command in ("run", "import", "respond", "decide"):
        shown = kouros(command, "--help", folder=tmp_path).stdout.splitlines()
        examples = [line for line in shown if "Example:" in line]
        assert len(examples) > 1, command
        assert all(line.count("Example:") == 1 and line.startswith("  Example: kouros ") for line in examples)
