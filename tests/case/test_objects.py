"""Cases as objects: SI numbers or text, changed by with_, told from the object, and the same in TOML."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import asperity
from asperity import (
    BallBearing,
    BallOnBeam,
    Bodies,
    HeightMap,
    Material,
    Profile,
    RollerBearing,
    WheelOnRail,
    laws,
)
from asperity.case.any_case import entries
from asperity.case.cases import as_case, parse_case, read_case
from asperity.errors import CaseError, InputError
from asperity.parameters import Choice, Flag, MaterialOrName, Number, Quantity, key
from asperity.reference.materials import MATERIALS
from asperity.scenarios.records import read_maps, spectrum_levels
from asperity.studies.definition import study_of
from asperity.surfaces.readers import read_all
from asperity.units import quantity, written
from refusals import refusals
from small_cases import changed

MAP = HeightMap(1e-7 * np.random.default_rng(1).normal(size=(40, 30)), 8e-6)
ROUGH = BallOnBeam(surface={"rms": 0.5e-6})
RAIL = WheelOnRail(surface={"spectrum": "iso3095"})
BASES = {"ball-on-beam": ROUGH, "wheel-on-rail": RAIL, "bodies": Bodies(surface={"rms": 0.5e-6})}


def listed(case, key):
    return {item["key"]: item for item in case.parameters()}[key]


class TestKeys:
    def test_a_number_is_in_si_and_the_same_as_its_text(self):
        number = BallOnBeam(speed=2, surface={"rms": 0.5e-6}, ball={"load": np.float32(5)})
        text = BallOnBeam(speed="2000 mm/s", surface={"rms": "0.5 um"}, ball={"load": "5 N"})
        assert number == text
        assert hash(number) == hash(text)
        assert number != ROUGH
        assert (number.speed, number.ball.load) == (2.0, 5.0)

    def test_sections_are_mappings_or_objects(self):
        assert BallOnBeam(surface=ROUGH.surface, ball=ROUGH.ball) == ROUGH
        with pytest.raises(CaseError, match="Surface: 1 error\n  - rms: received -1"):
            type(ROUGH.surface)(rms=-1)

    def test_lists_may_be_arrays(self):
        case = BallOnBeam(surface={"rms": 1e-6}, beam={"sensors": np.array([0.25, 0.5])})
        assert case.beam.sensors == (0.25, 0.5)

    def test_a_material_may_be_an_object(self):
        brass = Material("brass", 100e9, 0.34, 8500.0, "a handbook")
        case = ROUGH.with_(ball={"material": brass})
        assert case.ball.material == brass
        assert parse_case(case.to_toml()) == case
        with pytest.raises(CaseError, match="youngs_modulus: received 1 Pa; allowed: 1 kPa to 10 TPa"):
            ROUGH.with_(ball={"material": Material("fog", 1.0, 0.3, 1000.0)})

    @pytest.mark.parametrize("value", [10**400, math.inf, math.nan, 1e31, True, None, [1], -1, 0])
    def test_numbers_that_are_none_are_refused(self, value):
        with pytest.raises(CaseError, match="- speed: received"):
            BallOnBeam(speed=value, surface={"rms": 1e-6})

    def test_a_case_does_not_change(self):
        with pytest.raises(AttributeError, match=r"speed of BallOnBeam .*case.with_\(speed=…\)"):
            ROUGH.speed = 2.0


class TestWith:
    def test_keys_of_sections_in_three_ways(self):
        ways = (
            ROUGH.with_(**{"ball.load": "5 N"}),
            ROUGH.with_(ball={"load": 5}),
            ROUGH.with_(ball=BallOnBeam(surface={"rms": 1e-6}, ball={"load": 5}).ball),
        )
        assert len(set(ways)) == 1
        assert ways[0].surface.rms == 0.5e-6
        assert ROUGH.ball.load is None

    def test_none_takes_a_key_out(self):
        case = BallOnBeam(speed=2, surface={"rms": 1e-6}, ball={"load": 5, "mass": 0.2})
        less = BallOnBeam(surface={"rms": 1e-6}, ball={"mass": 0.2})
        assert case.with_(speed=None, **{"ball.load": None}) == less

    def test_laws_follow_the_surface_until_they_are_chosen(self):
        line = ROUGH.with_(surface={"rms": None, "spectrum": "iso3095"})
        assert line.laws == ("hertz-filtered", "linear-filtered")
        assert listed(line, "laws")["is_default"]
        chosen = ROUGH.with_(laws=["areal"])
        with pytest.raises(CaseError, match='"areal" with a path given as a line'):
            chosen.with_(surface={"rms": None, "spectrum": "iso3095"})

    @pytest.mark.parametrize("name", ["spede", "ball.lode", "bal.load", "kind", "a.b.c"])
    def test_unknown_keys_are_refused(self, name):
        with pytest.raises(CaseError, match=name.split(".")[0]):
            ROUGH.with_(**{name: "wheel-on-rail"})

    def test_what_a_case_says_of_itself_follows(self):
        case = ROUGH.with_(speed="2 m/s", seed=7)
        told = {"value": "2 m/s", "default": "1 m/s", "is_default": False, "note": "rolling speed"}
        assert listed(case, "speed") == {"key": "speed"} | told
        assert 'speed = "2 m/s"' in case.text
        assert case.text == case.to_toml()
        assert repr(case) == "BallOnBeam(speed='2 m/s', seed=7, surface={'rms': '0.5 um'})"


class TestInMemory:
    def test_an_array_needs_its_pixel_and_is_the_same_as_a_map(self):
        case = BallOnBeam(surface={"file": MAP})
        assert BallOnBeam(surface={"file": MAP.heights, "pixel": 8e-6}) == case
        assert BallOnBeam(surface={"file": MAP.heights * 1e6, "pixel": "8 um", "height_unit": "um"}).laws
        assert BallOnBeam(surface={"file": HeightMap(2 * MAP.heights, 8e-6)}) != case
        assert hash(BallOnBeam(surface={"file": HeightMap(MAP.heights, 9e-6)})) != hash(case)
        assert pickle.loads(pickle.dumps(case)) == case  # noqa: S301 (as executors do)
        ensemble = BallOnBeam(surface={"file": np.stack([MAP.heights, -MAP.heights]), "pixel": 8e-6})
        assert len(ensemble.surface.file) == 2
        assert ensemble == BallOnBeam(surface={"file": [MAP, HeightMap(-MAP.heights, 8e-6)]})

    def test_it_is_described_but_not_written(self):
        case = BallOnBeam(surface={"file": MAP})
        with pytest.raises(InputError, match=r"surface.file: received height map of 40 × 30 points.*np.save"):
            case.to_toml()
        digest = case.text.split("sha256 ")[1][:16]
        assert digest in listed(case, "surface.file")["value"]
        assert digest not in BallOnBeam(surface={"file": HeightMap(2 * MAP.heights, 8e-6)}).text
        with pytest.raises(CaseError, match="no such file"):
            parse_case(case.text)

    def test_it_is_saved_beside_its_case_which_computes_the_same_to_the_last_bit(self, tmp_path):
        """A map, an ensemble, a line; files of an earlier save are written again."""
        step = 0.1 + 0.2  # a number whose digits go on
        line = Profile(1e-6 * np.random.default_rng(0).normal(size=(400)), 1e-3 * step)
        maps = [HeightMap(sign * MAP.heights, 1e-5 * step) for sign in (1.0, -1.0)]
        for surface in ({"file": maps[0]}, {"file": maps}, {"file": maps[0], "line": line}):
            case = BallOnBeam(surface=surface)
            saved = read_case(case.save(tmp_path / "new" / "case.toml"))
            assert saved.in_memory == {}
            for found, held in zip(read_maps(saved.surface), read_maps(case.surface), strict=True):
                np.testing.assert_array_equal(found.heights, held.heights)
                assert found.spacing == held.spacing
        (found,) = read_all(saved.surface.line, height_unit="m", pixel=f"{saved.surface.line_spacing!r} m")
        np.testing.assert_array_equal(found.heights, line.heights)
        assert found.spacing == line.spacing
        assert sorted(path.name for path in (tmp_path / "new").iterdir()) == [
            "case.toml",
            "case_surface_file.npy",
            "case_surface_line.npy",
        ]

    def test_a_saved_case_runs_to_the_same_bits(self, own_cache, tmp_path):
        """What the page of a run says under Make it again."""
        rough = HeightMap(4e-8 * np.random.default_rng(1).normal(size=(80, 40)), 20e-6)
        case = changed("ball-on-beam", laws=["areal", "linear-filtered"], surface={"file": rough})
        first = asperity.run(case)
        again = asperity.run(case.save(tmp_path / "case.toml"))
        for group in first.children:
            for name, values in first[group].data_vars.items():
                np.testing.assert_array_equal(again[group][name].values, values.values, err_msg=str(name))

    def test_what_no_array_holds_is_refused_with_what_to_save_first(self, tmp_path):
        oblong = {"file": HeightMap(MAP.heights, (8e-6, 9e-6))}
        table = {"spectrum": np.array([[0.1, 3.0], [0.08, 2.0], [0.063, 1.0]])}
        for surface, named in ((oblong, "surface.file"), (table, "surface.spectrum")):
            with pytest.raises(InputError, match=rf"{named}: received .*Save it first, as np.save"):
                BallOnBeam(surface=surface).save(tmp_path / "case.toml")
        with pytest.raises(InputError, match=r'path: received .*as "case.toml"'):
            BallOnBeam(surface={"file": MAP}).save(tmp_path / "case.txt")
        assert list(tmp_path.iterdir()) == []

    def test_a_map_gives_what_its_file_gives(self, tmp_path):
        np.save(tmp_path / "map.npy", MAP.heights)
        on_disk = {"file": tmp_path / "map.npy", "pixel": "8 um", "height_unit": "m"}
        (found,), (held,) = (read_maps(BallOnBeam(surface=s).surface) for s in (on_disk, {"file": MAP}))
        np.testing.assert_array_equal(found.heights, held.heights)
        assert found.spacing == held.spacing

    def test_lines_and_tables_of_a_wheel(self, tmp_path):
        bands = np.array([[0.1, 3.0], [0.08, 2.0], [0.063, 1.0]])
        np.savetxt(tmp_path / "levels.csv", bands, delimiter=",", header="wavelength (m), level (dB)")
        modes = np.array([[1000.0, 1e-3, 300.0]])
        case = WheelOnRail(surface={"spectrum": bands}, wheel={"modes": modes})
        on_disk = WheelOnRail(surface={"spectrum": tmp_path / "levels.csv"})
        found, held = (spectrum_levels(each.surface.spectrum)[:2] for each in (on_disk, case))
        np.testing.assert_allclose(found, held)
        assert "table of 3 × 2 numbers" in case.text
        turn = Profile(1e-6 * np.random.default_rng(0).normal(size=2890), 1e-3)
        head = Profile(np.linspace(-0.02, 0.02, 41) ** 2 / -0.6, 1e-3)
        WheelOnRail(wheel={"line": turn}, track={"rail_profile": head})
        with pytest.raises(CaseError, match=r"an array of shape \(n, 3\)"):
            case.with_(wheel={"modes": modes[:, :2]})
        with pytest.raises(CaseError, match="a gap in the bands"):
            case.with_(surface={"spectrum": bands[::2]})


test_what_is_wrong_with_it_is_told = refusals(
    ({"file": MAP.heights}, "surface.pixel: received nothing; allowed: the distance of the points"),
    ({"file": MAP, "pixel": 1e-6}, "surface.pixel: received 1e-06; allowed: only together with a file"),
    ({"file": MAP.heights[0], "pixel": 1e-6}, "an array of 2 dimensions or 3 dimensions"),
    ({"file": Profile(MAP.heights[0], 1e-6)}, "surface.file: .*or a HeightMap"),
    ({"file": np.array([["a", "b"]] * 2), "pixel": 1e-6}, "surface.file"),
    ({"line": MAP.heights[0]}, "surface.line_spacing: received nothing"),
    ({"file": [MAP, 3]}, "surface.file: received"),
    of=lambda surface: BallOnBeam(surface=surface),
    error=CaseError,
)


def values_of(entry):
    """Strategy for legal values of a key alone, in SI; None for keys that name files or go with others."""
    kind = entry.key.kind
    if entry.name in ("kind", "smooth") or entry.key.goes_with:
        return None
    if isinstance(kind, Choice) and entry.name != "spectrum":
        return st.sampled_from(kind.known)
    if isinstance(kind, Flag):
        return st.booleans()
    if isinstance(kind, MaterialOrName):
        names = st.sampled_from(["brass", "Ω–metal", '"quoted"'])
        numbers = st.floats(1e9, 9e11), st.floats(0.0, 0.49), st.floats(500.0, 9e3)
        own = st.builds(Material, names, *numbers, st.sampled_from(["", "a book"]))
        return st.sampled_from(["steel", "aluminium"]) | own
    usual = entry.key.written_example
    if isinstance(kind, Number) and not kind.whole and isinstance(usual, int | float):
        return st.floats(0.5, 1.0).map(lambda share: usual * share)
    if isinstance(kind, Quantity) and usual != "inf" and "[" not in str(usual):
        size = quantity(str(usual), kind.dimension)
        return st.floats(0.9, 1.1).map(lambda share: size * share)
    return None


KNOWN = {
    name: {e.dotted: found for e in entries(type(base)) if (found := values_of(e)) is not None}
    for name, base in BASES.items()
}


@settings(max_examples=30, suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow])
@given(st.data())
@pytest.mark.parametrize("kind", sorted(BASES))
def test_a_case_that_is_written_and_read_is_the_same(kind, data):
    known = KNOWN[kind]
    assert len(known) > 20
    chosen = data.draw(st.lists(st.sampled_from(sorted(known)), max_size=5, unique=True))
    changes = {name: data.draw(known[name], label=name) for name in chosen}
    try:
        case = BASES[kind].with_(**changes)
    except CaseError:
        assume(False)
    again = parse_case(case.to_toml())
    assert again == case
    assert hash(again) == hash(case)
    assert again.parameters() == case.parameters()
    assert again.to_toml() == case.to_toml() == case.text
    assert eval(repr(case), {each.__name__: each for each in (BallOnBeam, WheelOnRail, Bodies)}) == case  # noqa: S307
    for name, value in changes.items():
        section, _, key = name.rpartition(".")
        if isinstance(value, float):
            assert getattr(getattr(again, section) if section else again, key) == value


@given(st.floats(1e-12, 1e12), st.sampled_from(["m", "N", "Pa", "m/s", "kg", "kg/m^3", "N s/m", "dB"]))
def test_a_quantity_is_written_to_the_last_bit(value, dimension):
    assert quantity(written(value, dimension, dimension, exactly=True), dimension) == value
    assert quantity(written(value, dimension, dimension), dimension) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize(
    ("dimension", "preferred", "unit"),
    [
        ("m", "um", "nm"),
        ("m", "mm", "um"),
        ("N/m", "MN/m", "kN/m"),
        ("Pa", "GPa", "MPa"),
        ("m/s", "km/h", "m/s"),
    ],
)
def test_a_quantity_comes_back_as_a_person_would_write_it(dimension, preferred, unit):
    """As 50 nm came back as 0.05000000000000001 um."""
    for number in (*range(1, 100), *np.arange(0.1, 30.0, 0.7).round(1).tolist()):
        value = quantity(f"{number} {unit}", dimension)
        text = written(value, dimension, preferred, exactly=True)
        assert quantity(text, dimension) == value
        assert len(text.partition(" ")[0]) <= 7


def test_units_suit_their_numbers():
    found = [written(v, "m", "mm") for v in (0.025, 1e-7, 2e-5, 300.0)]
    assert found == ["25 mm", "100 nm", "0.02 mm", "300 m"]
    assert written(0.0, "N s/m", "N s/m") == "0 N s/m"
    assert written(math.pi, "m/s", "m/s", exactly=True) == "3.141592653589793 m/s"
    assert written(3.0, "dB", "dB") == "+3 dB"
    assert written(math.inf, "m", "m") == "inf"


class TestStudies:
    def test_of_an_object_with_numbers(self):
        case = BallOnBeam(laws=["hertz"], surface={"spectrum": "iso3095", "level": -40})
        plan = study_of(case, {"ball.load": [5, np.float64(6.0)], "seed": np.arange(1, 3)})
        assert plan.sweep == {"ball.load": ["5 N", "6 N"], "seed": [1, 2]}
        assert plan.members()[0].case == case.with_(**{"ball.load": 5})
        assert parse_case(plan.text) == case

    def test_a_law_from_a_notebook_is_varied_by_a_key_of_its_own(self):
        """What other processes do not know is rolled in this one: the damper takes energy."""

        def build(materials):
            damper = materials.parameters["viscosity"]
            return laws.HertzLaw(materials.hertz_constant, materials.line, damper, materials.name)

        damper = key(Quantity("N s/m", at_least=0.0), "0 N s/m", "damper in the contact")
        laws.register(laws.LawSpec("damped", "Smooth contact.", build, parameters={"viscosity": damper}))
        try:
            surface = {"spectrum": "iso3095", "level": -40}
            case = BallOnBeam(laws=["damped"], duration=0.05, settling=0.02, surface=surface)
            table = asperity.study(case, {"damped.viscosity": [0, 30.0]})
        finally:
            laws.unregister("damped")
        none, some = table["force_level_a"].sel(law="damped").values
        assert none > some + 0.1

    def test_surfaces_in_memory_may_be_swept(self):
        other = HeightMap(-MAP.heights, 8e-6)
        first, second = study_of(BallOnBeam(surface={"file": MAP}), {"surface.file": [MAP, other]}).members()
        assert first.case.surface.file is MAP
        assert second.case.surface.file is other
        assert first.key != second.key
        with pytest.raises(CaseError, match="more than once"):
            study_of(ROUGH, {"surface.file": [MAP, HeightMap(MAP.heights, 8e-6)]})


# --- materials by numbers, wherever a name may stand

CASE = {
    "kind": "ball-on-beam",
    "duration": "4 ms",
    "laws": ["hertz"],
    "surface": {"spectrum": "iso3095"},
    "ball": {"material": "glass", "load": "5 N"},
    "beam": {"material": "aluminium"},
}
ALUMINIUM = {"youngs_modulus": "70 GPa", "poisson_ratio": 0.3, "density": "2.7 g/cm^3"}
TOML = '{ youngs_modulus = "70 GPa", poisson_ratio = 0.3, density = "2.7 g/cm^3" }'


def with_beam_of(material):
    return CASE | {"beam": {"material": material}}


def test_numbers_of_a_named_material_act_as_that_material():
    """1/E* adds compliances; a beam's natural frequencies go with the root of E/rho."""
    named, own, heavy = (
        as_case(with_beam_of(material))
        for material in ("aluminium", ALUMINIUM, ALUMINIUM | {"density": "10.8 g/cm^3"})
    )
    modulus = 1 / ((1 - 0.2**2) / 70e9 + (1 - 0.3**2) / 70e9)
    for case in (named, own, heavy):
        assert case.smooth_contact.modulus == pytest.approx(modulus, rel=1e-12)
    usual, same, slower = (case.beam.model(5e3).natural_frequencies for case in (named, own, heavy))
    np.testing.assert_allclose(same, usual, rtol=1e-14)
    np.testing.assert_allclose(slower[: len(usual)], 0.5 * usual, rtol=1e-12)


def test_titles_and_parameters_name_them():
    brass = {"name": "brass", "youngs_modulus": "100 GPa", "poisson_ratio": 0.34, "density": "8500 kg/m^3"}
    own = as_case(with_beam_of(ALUMINIUM))
    titles = [case.title for case in (as_case(CASE), own, as_case(with_beam_of(brass)))]
    assert titles == [f"Glass ball on {beam} beam" for beam in ("an aluminium", "a 70 GPa", "a brass")]
    row = next(row for row in own.parameters() if row["key"] == "beam.material")
    assert row["value"] == "youngs_modulus 70 GPa, poisson_ratio 0.3, density 2700 kg/m^3"
    assert not row["is_default"]


def test_a_case_file_has_them_in_braces_or_below():
    below = '[beam.material]\nyoungs_modulus = "70 GPa"\npoisson_ratio = 0.3\ndensity = "2.7 g/cm^3"\n'
    for text in (f"[beam]\nmaterial = {TOML}\n", below):
        found = parse_case(f'kind = "ball-on-beam"\n[surface]\nrms = "1 um"\n{text}').beam.material
        assert found == as_case(with_beam_of(ALUMINIUM)).beam.material


def test_a_study_may_sweep_them():
    plan = study_of(CASE, {"beam.material": ["aluminium", ALUMINIUM | {"density": "3 g/cm^3"}]})
    first, second = plan.members()
    assert first.case.beam.material == MATERIALS["aluminium"]
    assert second.case.beam.material.density == pytest.approx(3000.0)
    assert first.key != second.key
    own = "youngs_modulus 70 GPa, poisson_ratio 0.3, density 3 g/cm^3"
    assert plan.axes[0].variable.values.tolist() == ["aluminium", own]
    assert "beam.material = youngs_modulus 70 GPa" in second.label


def test_all_that_is_wrong_is_said_at_once():
    wrong = {"youngs_modulus": "70", "poison_ratio": 0.3, "poisson_ratio": 0.6, "name": ""}
    with pytest.raises(CaseError) as caught:
        as_case(with_beam_of(wrong))
    errors = caught.value.errors
    assert len(errors) == 5
    text = "\n".join(errors)
    for message in (
        "beam.material.poison_ratio: received an unknown key; allowed: name, youngs_modulus, poisson_ratio, "
        'density, citation. Did you mean "poisson_ratio"?',
        "beam.material.youngs_modulus: received '70'; allowed: a pressure greater than 0",
        "beam.material.poisson_ratio: received 0.6; allowed: a number greater than -1 and at most 0.5.",
        'beam.material.density: received nothing; allowed: a density greater than 0, with its unit, as "2700',
        "beam.material.name: received ''; allowed: a text in quotes.",
    ):
        assert message in text
    swift = {"youngs_modulus": "70 GPa", "poisson_ratio": 0.3, "density": "2.7 kg/m^3"}
    with pytest.raises(CaseError, match=r"beam\.material: .* bar at 161000 m/s; allowed: at most 36000"):
        as_case(with_beam_of(swift))
    with pytest.raises(CaseError, match=r'received \[\].*or numbers: \{ youngs_modulus = "72 GPa"'):
        as_case(with_beam_of([]))


RUNS = {
    "ball-bearing": (BallBearing, {"bearing": {"name": "6205"}, "laws": ["hertz"]}),
    "roller-bearing": (RollerBearing, {"bearing": {"name": "NU205"}, "laws": ["areal"]}),
}


@pytest.mark.parametrize("kind", RUNS)
def test_a_bearing_is_built_once_from_its_keys_to_its_result(monkeypatch, kind):
    model, keys = RUNS[kind]
    built = []
    check = model.__post_init__
    monkeypatch.setattr(model, "__post_init__", lambda self: (built.append(self), check(self)))
    turning = {"radial": "100 N", "speed": "18000 1/min", "duration": "10 ms", "settling": "2 ms"}
    case = as_case({"kind": kind, **turning, **keys})
    asperity.run(case)
    assert len(built) == 1
    changed = case.with_(**{"bearing.clearance": "5 um"})
    assert changed.bearing.bearing.clearance == pytest.approx(5e-6)
    assert pickle.loads(pickle.dumps(case)).bearing.bearing == case.bearing.bearing  # noqa: S301
