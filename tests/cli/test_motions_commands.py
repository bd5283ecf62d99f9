"""kouros motions, as a seismologist types it."""

import json
from pathlib import Path
from typing import Any

import pytest

from pipeline.motions import read_motion
from pipeline.quantities import G
from tests.museum import kouros, own_site, workspace

pytestmark = pytest.mark.slow_file


@pytest.mark.long("cli/test_select_command::test_select_says_what_is_lacking_and_writes_the_best_only_when_asked")
def test_list_and_process_write_a_site_that_is_the_same(tmp_path: Path) -> None:
    listed = kouros("motions", "list", "demo", folder=tmp_path)
    assert listed.returncode == 0
    assert "Ridgecrest 2019 M7.1, CI.CLC" in listed.stdout
    assert "0.700" in listed.stdout
    done = kouros("motions", "process", "demo", "--out", "processed", "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(done.stdout)["motions"]
    assert row["pga"] == pytest.approx(0.7 * G, rel=1e-12)
    (again,) = read_motion(tmp_path / "processed")
    assert again.hash == row["hash"]
    twice = kouros("motions", "process", "demo", "--out", "processed", folder=tmp_path)
    assert twice.returncode == 4
    assert "nothing is overwritten" in twice.stderr


def test_without_settings_a_site_must_be_named(tmp_path: Path) -> None:
    done = kouros("motions", "list", folder=tmp_path)
    assert done.returncode == 2
    assert "name a site's folder" in done.stderr
    workspace(tmp_path)
    assert kouros("motions", "list", folder=tmp_path).returncode == 0


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], str]:
    """What is told of the demonstration's record, and its page."""
    folder = tmp_path_factory.mktemp("shown")
    done = kouros("motions", "show", "demo", "--out", "page.html", "--json", folder=folder)
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    (record,) = answer["records"]
    return record, (folder / answer["page"]).read_text(encoding="utf-8")


def test_show_writes_the_page(shown: tuple[dict[str, Any], str], tmp_path: Path) -> None:
    record, page = shown
    assert record["highpass_hz"] == 0.1
    assert record["measures"]["pga"] == pytest.approx(0.7 * G, rel=1e-12)
    assert len(record["spectra"]["rotd100"]["psa"]) == len(record["spectra"]["rotd100"]["damping"])
    assert "Ridgecrest 2019 M7.1" in page
    wrong = kouros("motions", "show", "demo", "--record", "absent", folder=tmp_path)
    assert wrong.returncode == 4
    assert "there is no record 'absent'" in wrong.stderr


def test_the_virtual_shake_table(tmp_path: Path) -> None:
    """A sine of 2 m/s2 on a friction of 0.25, which it does not reach; 0.1 slips."""
    kinds = kouros("motions", "synthesise", folder=tmp_path)
    assert "mavroeidis_papageorgiou" in kinds.stdout
    words = ["amplitude=2", "frequency=2", "cycles=10", "--out", "shake"]
    made = kouros("motions", "synthesise", "sine", *words, folder=tmp_path)
    assert made.returncode == 0, made.stderr
    run = kouros("respond", "sliding", "friction_static=0.1,0.25", "--site", "shake", "--json", folder=tmp_path)
    slipped, held = json.loads(run.stdout)
    assert slipped["displacement"] > 0.0
    assert held["displacement"] == 0.0
    # A stiff plinth passes the sine on as it is; one in resonance lifts it over the friction.
    chain = ["--site", "shake", "--json", "--through"]
    stiff = kouros(
        "respond", "sliding", "friction_static=0.25", *chain, "plinth:frequency=50,damping=0.05", folder=tmp_path
    )
    loose = kouros(
        "respond", "sliding", "friction_static=0.25", *chain, "plinth:frequency=2,damping=0.05", folder=tmp_path
    )
    assert json.loads(stiff.stdout)[0]["displacement"] == 0.0
    assert json.loads(loose.stdout)[0]["displacement"] > 0.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["sin"], "there is no signal 'sin'"),
        (["sine", "amplitude=2"], "--out FOLDER"),
        (["sine", "amplitude=2", "--out", "x"], "sine needs frequency, cycles"),
        (["sine", "height=2", "--out", "x"], "sine takes amplitude="),
        (["sine", "amplitude=much", "--out", "x"], "amplitude: 'much' is not a number"),
        (["sine", "amplitude=1", "amplitude=2", "--out", "x"], "amplitude is given twice"),
        (["sine", "amplitude=-1", "frequency=1", "cycles=1", "--out", "x"], "amplitude"),
    ],
)
def test_signals_that_cannot_be_made(tmp_path: Path, words: list[str], message: str) -> None:
    done = kouros("motions", "synthesise", *words, folder=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert not (tmp_path / "x").exists()


def cut_short(folder: Path) -> Path:
    """The bundled site with its window cut amid the strong shaking."""
    return own_site(folder, window_s=(20.0, 38.0))


def test_accept_overrules_a_judgement_and_the_manifest_remembers(tmp_path: Path) -> None:
    site = cut_short(tmp_path)
    before = (site / "manifest.toml").read_text(encoding="utf-8")
    refused = kouros("motions", "list", "site", folder=tmp_path)
    assert refused.returncode == 4
    assert "ends during strong shaking" in refused.stderr
    assert "accept.cut_off" in refused.stderr
    name = "Ridgecrest 2019 M7.1, CI.CLC"
    nameless = kouros("motions", "process", "site", "--accept", "enough for a test", folder=tmp_path)
    assert nameless.returncode == 2
    words = ["motions", "process", "site", "--record", name, "--accept"]
    done = kouros(*words, 'enough for a "test"', folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("overruled: ")
    after = (site / "manifest.toml").read_text(encoding="utf-8")
    # All that was there is there still, comments included.
    assert set(before.splitlines()) <= set(after.splitlines())
    assert any('accepted: enough for a "test"' in step for step in read_motion(site)[0].steps)
    again = kouros(*words, "once more", folder=tmp_path)
    assert "nothing was refused" in again.stdout
    assert (site / "manifest.toml").read_text(encoding="utf-8") == after


def test_accept_never_overrules_what_is_corrupt(tmp_path: Path) -> None:
    site = cut_short(tmp_path)
    (file,) = site.glob("*HNE*.mseed")
    file.write_bytes(file.read_bytes()[:-100])
    before = (site / "manifest.toml").read_bytes()
    words = ["motions", "process", "site", "--record", "Ridgecrest 2019 M7.1, CI.CLC", "--accept", "please"]
    done = kouros(*words, folder=tmp_path)
    assert done.returncode == 4
    assert "has changed" in done.stderr
    assert (site / "manifest.toml").read_bytes() == before


def test_compare_says_which_measures_and_verdicts_a_swap_moves(tmp_path: Path) -> None:
    workspace(tmp_path)
    weak = own_site(tmp_path)
    manifest = weak / "manifest.toml"
    manifest.write_text(manifest.read_text().replace("scale_to_pga_g = 0.7", "scale_to_pga_g = 0.07"))
    none = kouros("motions", "compare", "brief", "site", folder=tmp_path)
    assert "there is no run yet" in none.stdout
    assert kouros("run", "-q", folder=tmp_path).returncode == 0
    same = kouros("-q", "motions", "compare", "brief", "brief", folder=tmp_path)
    assert "the same samples" in same.stdout
    assert "none changes" in same.stdout
    done = kouros("-q", "motions", "compare", "brief", "site", "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    swap = json.loads(done.stdout)
    (pair,) = swap["pairs"]
    before, after = pair["measures"]["pga"]
    assert before / after == pytest.approx(10.0, rel=1e-9)
    assert swap["basis"].startswith("the verdicts of the last run")
    assert swap["verdicts"]
    assert sum(swap["moved"].values()) == len(swap["verdicts"])
    # A tenth of the shaking makes nothing worse.
    order = {"pass": 0, "undetermined": 1, "fail": 2}
    assert all(order[v["after"]] < order[v["before"]] for v in swap["verdicts"])
    turned = kouros("-q", "motions", "compare", "site", "brief", folder=tmp_path)
    # The other way round the last run has no verdicts under the first site's motions.
    assert "that it did not have on these motions and records" in turned.stdout


def test_a_site_is_compared_with_itself_at_another_corner(shown: tuple[dict[str, Any], str], tmp_path: Path) -> None:
    """PGVs of the demonstration's record, high-passed at 0.1 and 0.05 Hz by scipy's sosfiltfilt: 28.0 and 34.2 east."""
    done = kouros("motions", "compare", "demo", "--corner", "0.5", "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    swap = json.loads(done.stdout)
    assert swap["new"].endswith("high-pass corners times 0.5)")
    (pair,) = swap["pairs"]
    before, after = pair["measures"]["pgv_x"]
    assert (before, after) == pytest.approx((0.280, 0.342), rel=0.01)
    record, _ = shown
    assert record["other_corners"]["highpass_hz"] == [0.05, 0.2]
    assert record["other_corners"]["pgd"][1] == pytest.approx(pair["measures"]["pgd_resultant"][1], rel=3e-3)
    alone = kouros("motions", "compare", "demo", folder=tmp_path)
    assert alone.returncode == 2
    assert "needs a second site, or --corner FACTOR" in alone.stderr
