"""A manifest is refused with its file, the key path and the remedy; the published schema says the same."""

import copy
import json
import tomllib

import jsonschema
import pytest
from pydantic import ValidationError

from pipeline.motions import Manifest, MotionError, load_manifest, manifest_schema, read_motion
from pipeline.resources import resource

DEMO = resource("site_motions", "demo")
SCHEMA = json.loads(resource("schemas", "site-manifest.schema.json").read_text(encoding="utf-8"))


def refused(path, *words):
    with pytest.raises(MotionError) as caught:
        load_manifest(path)
    assert caught.value.exit_code == 4
    for word in ("manifest.toml", *words):
        assert word in str(caught.value)


def test_the_published_schema_is_that_of_the_code():
    assert manifest_schema() == SCHEMA, (
        "write manifest_schema() as JSON, indent 2, to schemas/site-manifest.schema.json"
    )


def demo():
    return tomllib.loads((DEMO / "manifest.toml").read_text(encoding="utf-8"))


RECORD = ("level", 0, "record", 0)
GOOD = [
    (("site", "vs30"), 760.0),
    (("level", 0, "return_period_years"), 475),
    (("level", 0, "combine"), "mean"),
    ((*RECORD, "lowpass_hz"), 30.0),
    ((*RECORD, "files"), ["sub/a.mseed", "b..c.mseed"]),
    ((*RECORD, "components", "HNZ", "orientation"), "down"),
    (("floor",), [{"name": "2", "height_ratio": 0.5, "period_s": 0.4}]),
    (("floor",), [{"name": "2", "height_ratio": 0.5}]),
    (
        ("floor",),
        [
            {
                "name": "2",
                "height_ratio": 0.5,
                "period_s": 0.4,
                "method": "modal",
                "damping": 0.05,
                "stiffness_ratio": 5.0,
                "modes": 4,
            }
        ],
    ),
    (("floor",), [{"name": "2", "record": [demo()["level"][0]["record"][0] | {"name": "up", "level": "design"}]}]),
    ((*RECORD, "highpass_hz"), "auto"),
    ((*RECORD, "highpass_hz"), "none"),
    ((*RECORD, "baseline"), {"method": "polynomial", "degree": 2, "of": "velocity"}),
    ((*RECORD, "baseline"), {"method": "two-segment", "t1_s": 10.0, "t2_s": 30.0}),
    ((*RECORD, "accept"), {"clipping": "the peak was compared with a neighbouring station"}),
    ((*RECORD, "resample_s"), 0.005),
    ((*RECORD, "origin_time"), "2019-07-06T03:19:53.04Z"),
    ((*RECORD, "vertical"), "estimated"),
    ((*RECORD, "v_max_cm_s"), 55.0),
    (("level", 0, "target"), {"periods_s": [0.1, 1.0], "psa_g": [1.0, 0.5]}),
    (("site", "x_azimuth"), 30.0),
    (("floor",), [{"name": "2", "record": demo()["level"][0]["record"][0] | {"name": "measured on the floor"}}]),
]
BAD = [
    ((*RECORD, "origin_time"), "2019-07-06 05:19:53+02:00"),
    ((*RECORD, "origin_time"), "yesterday"),
    ((*RECORD, "window_s"), [-20.0, 120.0]),
    ((*RECORD, "vertical"), "guessed"),
    ((*RECORD, "start_m_s"), [0.1, 0.2]),
    ((*RECORD, "start_m_s"), [0.1, 0.2, 0.0]),
    (("colour",), "red"),
    (("site", "vs_30"), 760.0),
    (("site", "latitude"), 91.0),
    (("site", "latitude"), "34"),
    (("site", "name"), ""),
    (("site", "name"), "a\u001b[31mred"),
    (("level", 0, "record"), []),
    (("level", 0, "combine"), "median"),
    (("level", 0, "return_period_years"), 0),
    ((*RECORD, "scale"), 1.0),
    ((*RECORD, "units"), "m/s2"),
    ((*RECORD, "processed"), "no"),
    ((*RECORD, "processed"), True),
    ((*RECORD, "highpass_hz"), -0.1),
    ((*RECORD, "scale_to_pga_g"), 21.0),
    ((*RECORD, "window_s"), [1.0]),
    ((*RECORD, "files"), []),
    ((*RECORD, "files"), ["/etc/passwd"]),
    ((*RECORD, "files"), ["../secret"]),
    ((*RECORD, "files"), ["a/../../secret"]),
    ((*RECORD, "files"), ["C:x"]),
    ((*RECORD, "files"), ["a\\b"]),
    ((*RECORD, "files"), ["a\n"]),
    ((*RECORD, "files"), [""]),
    ((*RECORD, "response"), "../CI.CLC.xml"),
    ((*RECORD, "sha256", "CI.CLC.xml"), "71c5"),
    ((*RECORD, "components", "HNE", "axis"), "z"),
    ((*RECORD, "components", "HNE", "orientation"), "up"),
    ((*RECORD, "components", "HNE", "orientation"), 361),
    ((*RECORD, "components", "HNZ", "orientation"), 0),
    (("floor",), [{"name": "2"}]),
    (("floor",), [{"name": "2", "height_ratio": 0.5, "damping": 0.05}]),
    (("floor",), [{"name": "2", "height_ratio": 0.5, "period_s": 0.4, "method": "modal"}]),
    (("floor",), [{"name": "2", "height_ratio": 0.5, "period_s": 0.4, "method": "spectral"}]),
    ((*RECORD, "highpass_hz"), "low"),
    ((*RECORD, "baseline"), {"method": "spline"}),
    ((*RECORD, "accept"), {"nan": "it looks fine"}),
    ((*RECORD, "accept"), {"clipping": ""}),
    ((*RECORD, "scale_to_target"), False),
    (("floor",), [{"name": "2", "height_ratio": 2.0, "period_s": 0.4}]),
]


def changed(path, value):
    data = copy.deepcopy(demo())
    table = data
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = value
    return data


@pytest.mark.parametrize(("path", "value"), GOOD)
def test_code_and_schema_accept_the_same(path, value):
    data = changed(path, value)
    jsonschema.Draft202012Validator(SCHEMA).validate(data)
    Manifest.model_validate_json(json.dumps(data))


@pytest.mark.parametrize(("path", "value"), BAD)
def test_code_and_schema_refuse_the_same(path, value):
    data = changed(path, value)
    assert not jsonschema.Draft202012Validator(SCHEMA).is_valid(data)
    with pytest.raises(ValidationError):
        Manifest.model_validate_json(json.dumps(data))


def test_the_demo_is_valid_and_complete():
    data = demo()
    jsonschema.Draft202012Validator(SCHEMA).validate(data)
    manifest = load_manifest(DEMO)
    assert load_manifest(DEMO / "manifest.toml") == manifest
    assert manifest.level[0].approved_by == ""


def test_unknown_key(three, write_manifest):
    three()
    refused(write_manifest(higpass_hz=0.1), "level[0].record[0].higpass_hz", "unknown key", "highpass_hz")
    refused(write_manifest(extra='[[floor]]\nname = "1"\nperiod = 2.0'), "floor[0].period", "unknown key", "period_s")


def test_unknown_key_in_a_component_and_missing_key(three, write_manifest):
    three()
    components = {"HNE": {"axis": "x", "orientation": 90, "azimuth": 90}, "HNN": {"axis": "y", "orientation": 0}}
    components["HNZ"] = {"axis": "z", "orientation": "up"}
    refused(write_manifest(components=components), "level[0].record[0].components.HNE.azimuth", "unknown key")
    refused(write_manifest(licence=None), "level[0].record[0].licence", "missing", "add it")


def test_changed_hash(three, write_manifest, write_trace, tmp_path):
    three()
    folder = write_manifest()
    path = tmp_path / "n.mseed"
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    refused(folder, "level[0].record[0].sha256.'n.mseed'", "changed", "new hash")


def test_missing_and_stray_hashes(three, write_manifest):
    three()
    refused(write_manifest(sha256={}), "sha256.'e.mseed'", "has no hash")
    refused(write_manifest(sha256={"other.mseed": "0" * 64}), "sha256.'other.mseed'", "does not name")


def test_missing_file(three, write_manifest, tmp_path):
    three()
    folder = write_manifest()
    (tmp_path / "z.mseed").unlink()
    refused(folder, "level[0].record[0].files", "no file 'z.mseed'")


@pytest.mark.parametrize("name", ["../e.mseed", "/etc/passwd", "a/../../b", "..", "a\\b", "C:e.mseed", "e\u0000.mseed"])
def test_path_escape(three, write_manifest, name):
    three()
    refused(
        write_manifest(response=name, units=None, processed=False, sha256={}), "level[0].record[0].response", "leaves"
    )


def test_link_out_of_the_folder(three, write_manifest, tmp_path, tmp_path_factory):
    three()
    outside = tmp_path_factory.mktemp("outside") / "e.mseed"
    (tmp_path / "e.mseed").rename(outside)
    (tmp_path / "e.mseed").symlink_to(outside)
    refused(write_manifest(), "link out of the site's folder")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"highpass_hz": 0.1}, ["highpass_hz", "never processed again"]),
        ({"scale": 2.0, "scale_to_pga_g": 0.7}, ["scale_to_pga_g", "keep one"]),
        ({"processed": False, "highpass_hz": 5.0, "lowpass_hz": 1.0}, ["highpass_hz", "below lowpass_hz"]),
        ({"window_s": [5.0, 2.0]}, ["window_s", "start before end"]),
        ({"files": ["e.mseed", "e.mseed", "z.mseed"]}, ["files", "twice"]),
    ],
)
def test_rules_between_keys(three, write_manifest, changes, words):
    three()
    refused(write_manifest(**changes), "level[0].record[0]", *words)


def test_axes_once_each(three, write_manifest):
    three()
    components = {c: {"axis": "x", "orientation": 90} for c in ("HNE", "HNN")}
    refused(write_manifest(components=components | {"HNZ": {"axis": "z", "orientation": "up"}}), "exactly once")


def test_two_floors_of_one_name(three, write_manifest):
    three()
    floor = '[[floor]]\nname = "2"\nheight_ratio = 0.5\nperiod_s = 0.4\n'
    refused(write_manifest(extra=floor + floor), "two floors", "'2'")


def test_approval_needs_a_date(three, write_manifest):
    three()
    refused(write_manifest(level='approved_by = "A. Engineer"'), "level[0]", "approved_on")
    folder = write_manifest(level='approved_by = "A. Engineer"\napproved_on = 2025-03-01')
    assert load_manifest(folder).level[0].approved_on.isoformat() == "2025-03-01"


@pytest.mark.parametrize(
    "text", ["[site", "name = \x00", "a = " + "[" * 5000, "[site]\nlatitude = inf", "[site]\nlatitude = nan"]
)
def test_broken_toml(tmp_path, text):
    (tmp_path / "manifest.toml").write_text(text)
    refused(tmp_path)


def test_not_utf8(tmp_path):
    (tmp_path / "manifest.toml").write_bytes(b'[site]\nname = "\xff"')
    refused(tmp_path, "UTF-8")


def test_no_manifest(tmp_path):
    refused(tmp_path, "there is no such file")
    with pytest.raises(MotionError, match="there is no such file"):
        read_motion(tmp_path / "nowhere")
