"""Named changes of a case, what they do to what is heard, and how sure that is."""

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray
from executors import Here

import asperity
from asperity.case.cases import as_case
from asperity.cli.studying import _blocks, _by_place
from asperity.errors import CaseError, InputError
from asperity.scenes import schema
from asperity.scenes.figures.effects import Effects, effects_table
from asperity.studies.axes import AS_IT_IS
from asperity.studies.definition import load_study, study_of
from asperity.studies.effects import _order, effects, what_helps, with_effects
from refusals import refusals
from small_cases import changed

TRACK = {"pad_stiffness": "400 MN/m", "pad_damping": "8 kN s/m"}
SHORT = {"laws": ["linear"], "duration": "0.1 s", "settling": "40 ms", "contact": {"spacing": "2 mm"}}
RAIL = changed("wheel-on-rail", track=TRACK, numerics={"highest_frequency": "2 kHz", "poles": 40}, **SHORT)
VARIANTS = {
    "soft": {"track.pad_stiffness": "times 0.25", "track.pad_damping": "times 0.25"},
    "smooth": {"surface.level": "minus 5 dB", "wheel": {"roughness_level": "minus 5 dB"}},
    "discs": {"wheel.roughness": "disc instead of cast-iron"},
    "slow": {"speed": "times 0.8"},
}


def values_of(case, changes, *names):
    """Values of keys of a case that is changed; None where it cannot be."""
    study = study_of(case, {"variant": {"new": changes}})
    member = study.members()[1]
    if member.case is None:
        return member.error.errors
    found = []
    for section, _, name in (each.rpartition(".") for each in names):
        found.append(getattr(getattr(member.case, section) if section else member.case, name))
    return found


# --- what is changed


@pytest.mark.parametrize(
    ("change", "key", "expected"),
    [
        ("times 0.5", "track.pad_stiffness", 200e6),
        ("times 2", "track.pad_damping", 16e3),
        ("times 0.8", "speed", 0.8 * 56.0),
        ("plus 40 MN/m", "track.pad_stiffness", 440e6),
        ("minus 40 MN/m", "track.pad_stiffness", 360e6),
        ("minus 5 dB", "surface.level", -5.0),
        ("plus 1.5 dB", "wheel.roughness_level", 1.5),
        ("times 0.5", "track.sleeper_spacing", 0.5 * asperity.Track.named("x2000").sleeper_spacing),
        ("minus 0.05", "track.rail_loss_factor", None),
        (250e6, "track.pad_stiffness", 250e6),
        ("250 MN/m", "track.pad_stiffness", 250e6),
        ("cast-iron instead of disc", "wheel.roughness", ["cast-iron"]),
        ("times 2", "contact.samples", 4),
        ("plus 1", "noise.vehicles", ["the case has no noise.vehicles, which goes with vehicle_length"]),
        ("disc instead of composite", "wheel.roughness", ["wheel.roughness is disc, not composite"]),
        ("times 2", "track.pad_loss_factor", ["the case has no track.pad_loss_factor"]),
        ("56 m/s", "speed", ["nothing changes: the case is so already"]),
    ],
)
def test_a_change_is_told_by_what_the_case_has(change, key, expected):
    found = values_of(RAIL, {key: change}, key)
    if expected is None:
        assert "rail_loss_factor" in found[0]
    else:
        assert found == (expected if isinstance(expected, list) else [pytest.approx(expected, rel=1e-12)])


def test_half_of_nothing_is_nothing():
    """Pads of one material keep their loss factor, whether the case tells it or a damper."""
    halved = {"track.pad_stiffness": "times 0.5", "track.pad_damping": "times 0.5"}
    names = "track.pad_stiffness", "track.pad_damping", "track.pad_loss_factor"
    lossy = changed("wheel-on-rail", track={"name": "nordborg-loss-factor"})
    loss = asperity.Track.named("nordborg-loss-factor")
    assert values_of(RAIL, halved, *names) == [200e6, 4e3, None]
    found = values_of(lossy, halved, *names)
    assert found == [pytest.approx(0.5 * loss.pad_stiffness), None, None]


def test_measured_rails_have_no_level():
    line = asperity.Profile(1e-6 * np.sin(np.arange(50_000.0)), 1e-3)
    case = asperity.WheelOnRail(surface={"line": line, "continuation": "repeat"}, duration="0.1 s")
    reason = "the case has no surface.level, which goes with spectrum"
    assert values_of(case, {"surface.level": "minus 5 dB"}) == [reason]


BOTH = {"surface.level": "minus 5 dB", "wheel.roughness_level": "minus 5 dB"}
LINE = asperity.Profile(1e-6 * np.sin(np.arange(50_000.0)), 1e-3)


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        (
            {"wheel": {"line": LINE}, "surface": {"spectrum": "iso3095"}},
            "the case has no wheel.roughness_level, which goes with roughness",
        ),
        (
            {"surface": {"line": LINE, "continuation": "repeat"}, "wheel": {"roughness": "disc"}},
            "the case has no surface.level, which goes with spectrum",
        ),
        (
            {"surface": {"spectrum": "iso3095"}},
            "the case has no wheel.roughness_level, which goes with roughness",
        ),
    ],
)
def test_what_a_variant_says_is_made_as_a_whole_or_left_out(keys, reason):
    """Neither "both smoother" that smooths one, nor a change of a track that was measured beside another."""
    case = asperity.WheelOnRail(**keys, duration="0.1 s")
    assert values_of(case, BOTH) == [reason]
    measured = RAIL.with_(track={"decay_rates": np.array([[100.0, 5.0], [125.0, 5.0], [160.0, 5.0]])})
    (why,) = values_of(measured, {"track.pad_stiffness": "times 0.5", "speed": "times 0.8"})
    assert "was measured on the track as it is" in why
    assert values_of(RAIL, BOTH, "surface.level", "wheel.roughness_level") == [-5.0, -5.0]


def test_a_measured_track_is_that_track():
    rates = np.array([[100.0, 5.0], [125.0, 5.0], [160.0, 5.0]])
    case = RAIL.with_(track={"decay_rates": rates})
    reason = "track.decay_rates was measured on the track as it is: leave it out to ask for another"
    assert values_of(case, {"track.pad_stiffness": "times 0.5"}) == [reason]
    assert values_of(case, {"track.rail_foot_width": "125 mm"}, "track.rail_foot_width") == [0.125]


def test_what_is_swept_besides_is_changed():
    """Sections in both forms, from a file; labels name the variants."""
    Path("study.toml").write_text(
        'case = "ball.toml"\n[sweep]\n"ball.load" = ["10 N", "20 N"]\n'
        '[sweep.variant."a tenth more"]\nball.load = "times 1.1"\n"speed" = "2 m/s"\n'
    )
    found = load_study("study.toml").members()
    assert [member.case.ball.load for member in found] == pytest.approx([10.0, 11.0, 20.0, 22.0])
    assert [member.case.speed for member in found] == [1.0, 2.0, 1.0, 2.0]
    assert found[1].label == "ball.load = 10 N, variant = a tenth more"


test_what_is_wrong_with_a_variant_is_explained = refusals(
    ({"a": {"track.pad": "times 2"}}, r'sweep.variant."a".track.pad: received an unknown key'),
    ({"a": {"speeds": "1 m/s"}}, r'sweep.variant."a".speeds: .*Did you mean "speed"'),
    ({"a": {"speed": "1 kg"}}, r'sweep.variant."a".speed: received .1 kg.*allowed: a speed'),
    ({"a": {"speed": "times fast"}}, r'sweep.variant."a".speed: received .fast.; allowed: a number'),
    ({"a": {"speed": "plus 3"}}, r'sweep.variant."a".speed: .*Add the unit'),
    ({"a": {"speed": "minus 3 kg"}}, r'sweep.variant."a".speed: .*a unit that converts to m/s'),
    ({"a": {"speed": "times -1"}}, r'"a".speed: received .times -1.; allowed: times a number greater'),
    ({"a": {"wheel.roughness": "wood instead of disc"}}, r'"a".wheel.roughness: received .wood'),
    ({"a": {"kind": "bodies"}}, r'"a".kind: received a key that is changed; allowed: one kind'),
    ({"a": {}}, r'sweep.variant."a": received {}; allowed: one key or more'),
    ({"a": 3}, r'sweep.variant."a": received 3; allowed: one key or more'),
    ({"as it is": {"speed": "1 m/s"}}, 'received this name; allowed: a name of one line other than "as'),
    ({"a\nb": {"speed": "1 m/s"}}, "received this name"),
    ({}, "sweep.variant: received {}; allowed: names, each with keys and their values"),
    ({"a": {"x": 1}, "b": {"y": 2}}, "2 errors"),
    ({"a": {"speed": "times " + 100_000 * " " + "\n2"}}, 'a".speed: received'),
    ({"a": {"track.mass_per_length": "1 kg/m", "track": {"mass_per_length": "2 kg/m"}}}, "key more than on"),
    ({"a": {f"speed{n}": 1 for n in range(50_000)}}, "20 errors"),
    of=lambda variant: study_of(RAIL, {"variant": variant}),
    error=CaseError,
)


# --- what it does


@pytest.fixture
def cache(cache_of_module, own_folder, monkeypatch):
    """What other tests here have computed is found."""
    monkeypatch.setenv("ASPERITY_CACHE", cache_of_module)


@pytest.fixture(scope="module")
def table(cache_of_module):
    return asperity.study(RAIL, {"seed": [1, 2, 3], "variant": VARIANTS}, executor=Here())


def test_five_decibels_of_roughness_are_five_decibels_of_force(table, cache):
    """The linear law is linear: what roughness makes falls by 5.0 dB, what the load alone makes stays.

    Amplitudes of both add in one way or the other: with a share ε of the load in the amplitude, the level
    falls by 5 dB and at most 20 lg((1 + 1.78 ε)/(1 − ε)) more or less, 1.78 = 10^(5/20).
    """
    bare = {"surface.level": "minus 60 dB", "wheel.roughness_level": "minus 60 dB"}
    load = asperity.study(RAIL, {"seed": [1], "variant": {"bare": bare}}, executor=Here())
    load = load["force_level"].sel(law="linear", seed=1, variant="bare")
    force = table["force_level"].sel(law="linear")
    change = force.sel(variant="smooth") - force.sel(variant=AS_IT_IS)
    share = 10.0 ** ((load - force.sel(variant=AS_IT_IS)) / 20.0)
    assert (np.abs(change + 5.0) < 20.0 * np.log10((1.0 + 1.79 * share) / (1.0 - share))).all()
    alone = (share < 2e-3).transpose(*change.dims).values
    assert alone.sum() > 15  # of three textures
    np.testing.assert_allclose(change.values[alone], -5.0, atol=0.02)
    found = effects(table)["effect"].sel(variant="smooth", radiator=["rail", "total"])
    np.testing.assert_allclose(found, -5.0, atol=0.03)


def test_effects_are_differences_within_one_texture(table):
    """Mean, and Student's interval of the mean, of paired differences; as printed for n = 3, t = 4.303."""
    level = table["radiated_power_level_a"].sel(law="linear", radiator="rail")
    paired = (level.sel(variant="soft") - level.sel(variant=AS_IT_IS)).values
    here = effects(table).sel(variant="soft", radiator="rail")
    assert float(here["effect"]) == pytest.approx(paired.mean())
    student = 4.3027 * np.std(paired, ddof=1) / np.sqrt(3)
    assert float(here["effect_error"]) == pytest.approx(student, rel=1e-4)
    assert float(here["effect_error"]) < np.ptp(level.sel(variant=AS_IT_IS).values)
    one = effects(table.isel(seed=[0]).squeeze("seed"))
    assert float(one["effect"].sel(variant="soft", radiator="rail")) == pytest.approx(paired[0])
    assert np.isnan(one["effect_error"]).all()
    assert effects(table, "force_level_a")["effect"].dims == ("variant",)


@pytest.mark.parametrize(("count", "words"), [(6, ""), (8, "6 of 8 values of speed are shown; the CSV")])
def test_effects_at_more_places_than_are_shown_are_counted(table, count, words):
    """From the first place to the last; what is left out is told under each table."""
    speeds = np.arange(1.0, count + 1.0)
    swept = table.isel(seed=0, drop=True).expand_dims(speed=speeds)
    swept["speed"].attrs |= {"units": "m/s", "long_name": "speed"}
    swept.attrs |= {"sweep": json.dumps({"speed": speeds.tolist(), "variant": VARIANTS})}
    told, left = _by_place(swept, effects(swept))
    assert [told[0][0], told[-1][0]] == ["speed = 1 m/s", f"speed = {count} m/s"]
    assert left.startswith(words)
    assert all((" are shown" in block.note) is bool(words) for block in _blocks(told, left))


def test_seeds_that_draw_nothing_say_nothing_of_chance(table, cache):
    """Measured lines: all seeds roll over the same, and a record is as sure as one."""
    one, three = (effects(table.isel(seed=places)) for places in ([0], [0, 0, 0]))
    assert np.isnan(three["effect_error"]).all()
    assert three.attrs["seeds"] == 1
    np.testing.assert_allclose(three["level_deviation"], one["level_deviation"])
    np.testing.assert_allclose(three["effect"], one["effect"], atol=1e-12)


def test_soft_pads_free_the_rail_and_calm_the_sleepers(table):
    """D. J. Thompson, Railway Noise and Vibration (Elsevier, 2009); and slower is quieter."""
    found = effects(table)
    soft = found["effect"].sel(variant="soft")
    assert float(soft.sel(radiator="rail")) > 1.0
    assert float(soft.sel(radiator="sleepers")) < -3.0
    assert float(found["effect"].sel(variant="slow", radiator="total")) < -1.0


@pytest.mark.long
def test_dampers_calm_what_they_sit_on(cache):
    """Thompson: rail dampers raise the decay rate and calm the rail; a wheel with damped modes rings less."""
    drawn = RAIL.with_(wheel={"section": "curved-web"}, numerics={"highest_frequency": "4 kHz"})
    listed = what_helps(drawn).sweep["variant"]
    dampers = {name: listed[name] for name in ("rail dampers", "wheel dampers")}
    found = effects(asperity.study(drawn, {"variant": dampers}, executor=Here()))["effect"]
    on_rail, on_wheel = (found.sel(variant=name) for name in dampers)
    assert float(on_rail.sel(radiator="rail")) < -2.0
    assert abs(float(on_rail.sel(radiator="sleepers"))) < 2.0
    assert float(on_wheel.sel(radiator="wheel")) < -3.0
    assert float(np.abs(on_wheel.sel(radiator=["rail", "sleepers"])).max()) < 1.5


def test_measured_pads_are_scaled():
    """To half the stiffness that they have where they are told by a number."""
    rows = np.array([[100.0, 300e6, 60e6], [300.0, 340e6, 70e6], [1000.0, 400e6, 80e6]])  # Hz, N/m
    case = changed("wheel-on-rail", track={"name": "uic60", "pad_table": rows})
    nominal = case.track.model().pad_stiffness
    assert nominal > 300e6
    halved = {"track.pad_stiffness": "times 0.5", "track.pad_damping": "times 0.5"}
    assert values_of(case, halved, "track.pad_stiffness") == [pytest.approx(0.5 * nominal)]


def test_the_quietest_comes_first_and_what_is_left_out_last(table):
    found = effects(table)
    total = found["effect"].sel(radiator="total").values
    assert (np.diff(total[:-1]) > 0.0).all()
    assert np.isnan(total[-1])
    assert found["variant"].values.tolist() == ["smooth", "slow", "soft", "discs"]
    assert found["left_out"].values.tolist() == ["", "", "", "wheel.roughness is disc, not cast-iron"]
    of = Effects(found)
    assert of.parts == ["total", "rail", "rail sideways", "sleepers"]  # the wheel is rigid, and silent
    rows = [[cell.text for cell in row] for row in effects_table(of).rows]
    assert [row[0] for row in rows] == [
        f"as it is, mean of {of.seeds} seeds",
        "smooth",
        "slow",
        "soft",
        "discs",
    ]
    assert rows[0][-1] == "Loudest: rail."
    assert rows[-1][1:] == ["–", "–", "–", "–", "Left out: wheel.roughness is disc, not cast-iron."]
    silent = "The total is without the wheel: of this wheel it is not known how its disc and tread vibrate."
    assert of.best == f"Helps most: smooth, −5.0 dB(A). {rows[1][-1]} {silent}"
    assert effects_table(of).note.endswith(silent)
    assert Effects(found.isel(variant=[2, 3])).best == ""


def test_a_reason_that_several_keys_have_is_told_once_in_a_cell(cache):
    """Of a measured track neither stiffness nor damping of the pads can be others, for one reason."""
    rates = np.array([[100.0, 5.0], [125.0, 5.0], [160.0, 5.0]])
    measured = RAIL.with_(track={"decay_rates": rates})
    found = asperity.study(measured, {"variant": {"soft": VARIANTS["soft"]}}, executor=Here())
    reason = "track.decay_rates was measured on the track as it is: leave it out to ask for another"
    (failure,) = json.loads(found.attrs["failures"])
    assert failure["message"].count(reason) == 2
    assert effects_table(Effects(effects(found))).rows[1][-1].text == f"Left out: {reason}."


def test_the_order_is_that_of_the_whole():
    """Not of the first part, and the mean over other keys; what has no effect is last."""
    effect = xarray.DataArray([[-3.0, 1.0], [np.nan, np.nan], [2.0, -1.0]], dims=("variant", "radiator"))
    assert _order(effect, ["variant"]).tolist() == [2, 0, 1]
    at_speeds = xarray.concat([effect, effect + 9.0, -3.0 * effect], "speed").transpose("variant", ...)
    assert _order(at_speeds, ["variant", "speed"]).tolist() == [0, 2, 1]


def said(level, effect, error, parts=("rail", "sleepers", "wheel", "total")):
    dims = ("variant", "radiator")
    held = {
        "effect": (dims, [effect]),
        "effect_error": (dims, [error]),
        "left_out": ("variant", [""]),
        "level": ("radiator", level, {"long_name": "", "units": "dB(A) re 1 pW"}),
    }
    at = {"variant": ["new"], "radiator": list(parts)}
    return Effects(xarray.Dataset(held, at, {"law": "areal", "seeds": 3})).in_words["new"]


def test_an_effect_is_said_in_words():
    level = [100.0, 90.0, 95.0, 101.5]
    words = said(level, [-2.1, 1.0, -0.01, -1.7], [0.1, 0.2, 0.0, 0.1])
    assert words == "Rail 2.1 dB down, sleepers 1.0 up."
    words = said(level, [-6.0, np.nan, 0.4, -3.0], [0.1, np.nan, 0.5, 0.1])
    assert words == "Rail 6.0 dB down; loudest then: wheel."
    assert said(level, [0.1, 0.1, 0.1, 0.1], [0.2] * 4) == "No change that is sure."
    assert said(level, [0.3, 0.0, 0.0, 0.2], [np.nan] * 4) == "Rail 0.3 dB up."


def test_other_tables_have_no_effects(table):
    for other in (table.isel(variant=0), 3):
        with pytest.raises(InputError, match='allowed: one with the dimension "variant"'):
            effects(other)
    with pytest.raises(InputError, match="quantity: received 'loudness'; allowed: one of"):
        effects(table, "loudness")


def test_more_variants_go_on_where_fewer_were(table, cache):
    """The case as it is, and what was changed before, are found; only the new one is computed."""
    again = Here()
    more = {"seed": [1], "variant": {**VARIANTS, "fast": {"speed": "times 1.1"}}}
    assert asperity.study(RAIL, more, executor=again)["completed"].values.tolist() == [[1, 1, 1, 0, 1, 1]]
    assert again.count == 1


# --- the ready list


def test_the_ready_list_suits_cases_over_a_track():
    """Its keys exist in both kinds of case; of the main law, from the seed of the case on."""
    laws = ["areal", "linear"]
    wheel = what_helps(changed("wheel-on-rail", laws=laws, seed=7))
    assert wheel.sweep["seed"] == [7, 8, 9]
    assert {tuple(member.case.laws) for member in wheel.members() if member.case} == {("areal",)}
    body = {"load": "40 kN", "masses": ["600 kg"], "distance": "2 m"}
    keys = {"over": "track", "laws": ["linear"], "surface": {"spectrum": "iso3095"}, "body": body}
    bodies = what_helps(changed("bodies", **keys))
    assert "body.roughness_level" in bodies.sweep["variant"]["wheel 5 dB smoother"]
    assert what_helps(RAIL, {"seed": [4]}).sweep["seed"] == [4]


def test_what_helps_stands_in_the_result_of_a_run(table, cache, monkeypatch):
    """As its schema says, with a chapter of the report."""
    plan = study_of(RAIL, {"seed": [1, 2, 3], "variant": VARIANTS})
    monkeypatch.setattr("asperity.studies.effects.what_helps", lambda case: plan)
    tree = with_effects(RAIL, asperity.run(RAIL, brief=True))
    assert xarray.Dataset.identical(tree["effects"].to_dataset(), effects(table))
    for name, values in tree["effects"].to_dataset().variables.items():
        entry = next(e for e in vars(schema).values() if getattr(e, "path", "") == f"effects/{name}")
        assert (values.dims, values.attrs["units"]) == (entry.dims, entry.units)
        assert values.attrs["long_name"] == entry.long_name
    page = asperity.report(tree, "page").read_text(encoding="utf-8")
    assert "Left out: wheel.roughness is disc, not cast-iron." in page
    assert "Helps most: smooth, " in page.partition("<main>")[0]
    assert "asperity run case.toml --what-helps" in page


QUIET = {
    "kind": "ball-bearing", "speed": "3600 1/min", "axial": "100 N", "laws": ["hertz"], "duration": "50 ms",
    "settling": "10 ms", "bearing": {"name": "6205"}, "inner_raceway": {"waviness": "20 nm"},
    "outer_raceway": {"waviness": "20 nm"},
}  # fmt: skip


def test_what_helps_a_bearing_is_told_by_its_velocities(cache, monkeypatch):
    """Under an axial load half of all waves are 6 dB less; a named bearing has a clearance to take from."""
    case = as_case(QUIET)
    every = what_helps(case)
    assert every.sweep["seed"] == [1, 2, 3]
    members = [member for member in every.members() if member.case]
    assert {tuple(member.case.laws) for member in members} == {("hertz",)}
    tighter = next(member.case for member in members if "less clearance" in member.label)
    assert tighter.bearing.clearance == pytest.approx(5e-6)
    chosen = {name: every.sweep["variant"][name] for name in ("all half as wavy", "balls half as wavy")}
    plan = study_of(case, {"variant": chosen})
    monkeypatch.setattr("asperity.studies.effects.what_helps", lambda case: plan)
    monkeypatch.setattr("asperity.studies.running.study", partial(asperity.study, executor=Here()))
    tree = with_effects(case, asperity.run(case, brief=True))
    found = tree["effects"].to_dataset()
    assert found["judged"].values.tolist()[-1] == "total"
    np.testing.assert_allclose(found["effect"].sel(variant="all half as wavy"), -6.02, atol=0.05)
    velocity = tree["bearing/band_velocity"].values[0, 0]
    np.testing.assert_allclose(found["level"][:3], 20.0 * np.log10(velocity / 1e-9), atol=1e-6)
    assert found["level"][-1] == pytest.approx(10.0 * np.log10(np.sum(velocity**2) / 1e-18))
    page = asperity.report(tree, "page").read_text(encoding="utf-8")
    assert "Helps most: all half as wavy, −6.0 dB." in page
    assert "Left out: the case has no balls.waviness." in page
