"""Whatever is wrong with a case is said: what was received, what is allowed, and what to do."""

import re

import pytest
from case_texts import case_text

from asperity.case.any_case import entries
from asperity.case.cases import parse_case, read_case
from asperity.case.toml import toml_value
from asperity.errors import CaseError, InputError

KINDS = {"ball": "ball-on-beam", "wheel": "wheel-on-rail", "bodies": "bodies"}
REFUSED = """
ball: [ball] radius = "25" → ball.radius: received '25'; allowed: a length greater than 0
ball: [ball] radius = 0.025 → Add unit and quotes: "0.025 m" if it is in SI units (m).
ball: [ball] radius = "0 mm" → greater than 0
ball: [ball] radius = "inf" → Give a finite value
ball: [ball] radius = true → ball.radius: received True
ball: [ball] material = "steal" → Did you mean "steel"?
ball: [ball] lode = "5 N" → keys of [ball]: radius, material, mass, load. Did you mean "load"?
ball: [ball] seed = 3 → Move it to the top of the case, above the first section.
ball: [ball] damping = "1 N s/m" → Move it to [contact].
ball: [beam] support = "pinned" → "simply-supported", "free", "clamped"
ball: [beam] loss_factor = -0.1 → a number at least 0 and at most 0.5
ball: [beam] loss_factor = "0.1" → Write it without quotes and unit
ball: [beam] sensors = "0.5 m" → beam.sensors: received '0.5 m'; allowed: a list, each a length
ball: [beam] sensors = ["0.5 m", 3] → beam.sensors[2]: received 3
ball: [beam] sensors = [] → at least 1, each a length at least 0
ball: [beam] sensors = ["1.2 m"] → beam.sensors: received 1.2 m; allowed: positions on it, 0 to 1 m
ball: [beam] suspension_frequency = "3 Hz" → only together with support = "free"
ball: [contact] window = "20 um" → contact.window: received 20 um, 2 cells of 10 um; allowed: 8 to 2048 cells
ball: [contact] window = "25 mm" → 2500 cells
ball: [contact] approaches = ["1 um"] → at least 2
ball: [contact] approaches = ["1 um", "0 um"] → approaches: received ['1 um', '0 um']; allowed: a list that
ball: [contact] filter_taps = 63 → an even number
ball: [contact] filter_degree = 6.5 → a whole number at least 1 and at most 20
ball: [contact] sample_length = "0.6 mm" → at least two windows, 1000 um
ball: [contact] normalise = "none" → "low-wavenumber", "tangent"
ball: [contact] spacing = "100 um" | window = "1 mm" → allowed: at most speed / (2.5 highest_frequency) = 80
ball: [numerics] time_step = "0.1 ms" → numerics.time_step: received 100 us
ball: [numerics] time_step = "1 ns" → 1·10⁹ time steps; allowed: at most 1·10⁸
ball: [numerics] rtol = 0 → a number greater than 0 and at most 0.01
ball: laws = [] → laws: received an empty list; allowed: at least 1, each "areal",
ball: laws = ["arreal"] → Did you mean "areal"?
ball: laws = "areal" → laws: received 'areal'; allowed: a list
ball: laws = ["areal", "areal"] → laws: received "areal" more than once; allowed: each once
ball: seed = -1 → a whole number at least 0
ball: start = "1 m" → start: received 1 m; allowed: a position on the beam
ball: duration = "1.5 s" → duration: received 1.5 s, which ends at 1.5 m; allowed: at most 1 s
ball: duration = 1979-05-27 → duration: received datetime.date(1979, 5, 27)
ball: ball = 3 → ball: received 3; allowed: a section [ball]
ball: [balls] radius = "1 mm" → balls: received an unknown key; allowed: keys at the top of a case
ball: [ball] radius = "0.2 mm" | [contact] window = "0.5 mm" → at most the smallest diameter of the bodies,
ball: settling = "2 s" → start, after settling: received 2 m; allowed: a position on the beam
ball: start = "0.1 m" | settling = "0.3 s" | duration = "0.1 s" → received 0.3 s, which begins at -0.2 m;
ball: [surface] smooth = false → surface: received no texture; allowed: file, rms, line, spectrum or a
ball: [surface] file = "map.npy" | rms = "1 um" → surface: received both file and rms; allowed: one of them
ball: [surface] file = "absent.npy" → absent.npy
ball: [surface] line = "line.csv" | spectrum = "iso3095" → surface: received both line and spectrum
ball: [surface] file = "map.npy" | height_unit = "s" → a unit of length, as "um"
ball: [surface] file = "map.npy" | fill = "yes" → true or false
ball: [surface] file = "map.npy" | direction = 30 → Add unit and quotes: "30 rad" if it is in SI units (rad)
ball: [surface] rms = "1 um" | direction = "90 deg" → surface.direction: received 1.5708 rad;
ball: [surface] rms = "1 um" | longest = "10 um" | shortest = "16 um" → surface.longest: received 10 um with
ball: [surface] rms = "1 um" | shortest = "10 um" | [contact] spacing = "8 um" → shortest: received 10 um on
ball: [surface] spectrum = "iso3095" | [contact] linearise = "rough" → contact.linearise: received "rough"
ball: [surface] file = "map.npy" | recipe = "recipe.toml" | fill = true → surface.fill: received True;
ball: [contact] window = "1e-7 mm" → contact.window: received 0.1 nm; allowed
ball: [ball] radius = "300 km" → ball.radius: received 300 km; allowed
ball: [surface] rms = "1e20 m" → received 1e+20 m; allowed: 1 pm to 1 mm. Less is smoother than atoms are,
wheel: [wheel] transverse_radius = "0 m" → a length greater than 0, or "inf", with its unit
wheel: [wheel] modes = "modes.csv" | receptance = "receptance.csv" → wheel: received both modes and receptance
wheel: [wheel] profile = "tread.csv" | transverse_radius = "1 m" → both profile and transverse_radius
wheel: [wheel] roughness = "disc" | line = "wheels.csv" → wheel: received both roughness and line
wheel: [wheel] flat_shape = "worn" → only together with flat_depth or flat_length
wheel: [wheel] flat_depth = "0.4 mm" | flat_length = "60 mm" → wheel.flat_length: received 60 mm beside a
wheel: [wheel] flat_depth = "0.4 mm" | flat_length = "60 mm" → A worn flat may be longer: flat_shape = "worn".
wheel: [wheel] flat_depth = "0.4 mm" | flat_length = "30 mm" | flat_shape = "worn" → sqrt(8 radius
wheel: [wheel] flat_length = "0.2 m" → received 200 mm; allowed: at most 0.01 of the radius deep
wheel: [wheel] flat_depth = "5 mm" → 4.6 mm, a chord of 130.1 mm
wheel: [wheel] flat_depth = "1 mm" | flat_position = "3 m" → received 3 m; allowed: less than the
wheel: [wheel] load = "5 kN" → wheel.load: received 5 kN; allowed: at least 5.88399 kN, the weight of 600 kg
wheel: [track] pad_damping = "18 kN s/m" | pad_loss_factor = 0.2 → both pad_damping and pad_loss_factor
wheel: [track] pad_table = "pad.csv" | pad_damping = "9 kN s/m" → both pad_table and pad_damping
wheel: [track] pad_table = "pad.csv" | pad_preload = "30 kN" → 30 kN for a table that is at no preload
wheel: [track] subgrade_stiffness = "9 MN/m" | subgrade_damping = "9 kN s/m" | subgrade_loss_factor = 1 → both
wheel: [track] rail_damper_mass = "15 kg" → no rail_damper_frequency
wheel: [track] sleeper_bending_stiffness = "6 MN m^2" | seat_distance = "2.6 m" → received seat_distance = 2.6
wheel: [track] sleeper_table = "pad.csv" → the heading 'real (MN/m)'
wheel: [track] shear_stiffness = "240 MN" → track: received no rotary_inertia
wheel: [track] pad_stiffness = "300 MN" → a stiffness greater than 0, with its unit, as "300 MN/m"
wheel: [sideways] contact_place = "40 mm" → received 40 mm; allowed: at most 36 mm off the middle
wheel: [sideways] contact_place = "-40 mm" → The rail head, track.rail_head_width, is no wider.
wheel: [creep] kinetic = 0.5 → only together with angle_of_attack or longitudinal or lateral or spin
wheel: [creep] lateral = 0.01 | falling_velocity = "1 m/s" → allowed: kinetic below 1. As kinetic = 0.5.
wheel: [track] rail_profile = "rail.csv" | rail_head_radius = "0.3 m" → both rail_head_radius and rail_profile
wheel: [track] points = ["60 m"] → received 60 m; allowed: positions that are passed, 0 m to 56 m
wheel: [numerics] poles = 99 → numerics.poles: received 99; allowed: an even number
wheel: [numerics] kernel = "scatter" | poles = 50 → only together with kernel = "poles"
wheel: speed = "500 m/s" → speed: received 500 m/s; allowed: zero or more, below the critical speed
wheel: duration = "0.1 ms" → duration: received 0.0001 s, in which 5.6 mm are rolled; allowed: at least con
wheel: duration = "2 ms" | [contact] filter_taps = 400 → and contact.filter_taps spacings, 200 mm
wheel: [surface] smooth = true | spectrum = "iso3095" → surface.smooth: received true beside a texture
wheel: [surface] spectrum = "absent.csv" → "cnossos-average", or the path of a table of wavelengths and
wheel: [surface] corrugation = "25 um" → surface.corrugation: received no corrugation_wavelength
wheel: [surface] corrugation = "25 um" | corrugation_wavelength = "0.5 mm" → 0.5 mm on a spacing of 0.5 mm;
wheel: [surface] joint_depth = "1 mm" | joint_position = "60 m" → received 60 m; allowed: a position that is
bodies: [body] positions = ["0.2 m", "0.2 m"] → two contacts in the same place
bodies: [body] positions = ["0 m", "3 m"] → less than the length of the beam, 1 m
bodies: start = "0.99 m" | [body] positions = ["0 m", "0.5 m"] → where the foremost contact is at its end
bodies: [body] masses = ["1 kg"] → body.masses: received 1 of a mass; allowed: no masses above
bodies: [body] type = "chain" → none of a chain
bodies: [body] type = "bogie" | masses = ["1 kg"] | springs = ["1 N/m"] → the distance of its contacts
bodies: [body] type = "chain" | masses = ["1 kg", "2 kg"] | springs = ["1 N/m"] → 1 under 2 masses; allowed:
bodies: [body] dampers = ["1 N s/m"] → 1 beside 0 springs
bodies: [body] type = "carriage" | masses = ["0.4 kg"] | distance = "20 mm" | load = "0.1 N" → presses on them
bodies: [body] type = "carriage" | masses = ["1 kg"] | contacts = 150 | positions = ["0 m", "1 m"] → 300
bodies: [body] distance = "1 m" → body.distance: received of a mass
bodies: [body] groove_radius = "25 mm" → body.groove_radius (m): received 0.025 and -0.025; allowed: bodies
bodies: [body] raceway_radius = "20 mm" | raceway = "outer" → body.raceway_radius (m): received 0.025 and
bodies: [body] transverse_radius = "inf" → body.groove_radius (m): received inf and inf
bodies: over = "track" | [beam] length = "2 m" → over: received "track"
bodies: over = "structure" → the file of its modes, or receptances
bodies: [beam] supports = ["0 m"] → none where an end is held
bodies: [beam] supports = ["0.3 m", "1.2 m"] → different positions on the beam of 1 m
bodies: [beam] supports = ["0.3 m"] | support = "free" → two supports or more
bodies: [noise] rail_distance = "1.5 m" → noise.rail_distance: received a key of a track; allowed: what a beam
bodies: [sideways] contact_place = "1 mm" → sideways.contact_place: received a key of a track
ball: [sideways] friction = 0.2 → sideways: received an unknown key
ball: [creep] spin = "9000 rad/m" → creep.spin: received 9000 rad/m; allowed: at most
"""


def errors_of(text, source="case.toml"):
    with pytest.raises(CaseError) as caught:
        parse_case(text, source)
    assert caught.value.exit_code == 2
    return caught.value.errors


@pytest.mark.parametrize("refused", REFUSED.strip().splitlines())
def test_what_is_wrong_is_said(refused, source):
    kind, _, rest = refused.partition(": ")
    text, _, message = rest.partition(" → ")
    errors = errors_of(case_text(KINDS[kind], text), source)
    assert any(message in error for error in errors), errors


def test_keys_that_go_with_others_are_refused_alone(source):
    base = parse_case(case_text("bodies", "[surface] smooth = true"))
    alone = [
        entry
        for entry in entries(type(base))
        if entry.key.goes_with and not getattr(base, entry.section).is_active(entry.name)
    ]
    assert len(alone) > 50
    for entry in alone:
        keys = f"[surface] smooth = true | [{entry.section}] {entry.name} = "
        keys = keys.replace("| [surface] ", "| ") + toml_value(entry.key.written_example)
        companion = entry.key.goes_with.partition("=")[0]
        told = re.compile(f"{entry.dotted}: received .*; allowed: only together with {companion}")
        assert any(map(told.match, errors_of(case_text("bodies", keys), source))), entry.dotted


def test_all_errors_are_reported_at_once():
    text = 'speed = "-1 m/s" | spede = 1 | [ball] radius = "25" | lods = "5 N" | [beam] loss_factor = nan'
    errors = errors_of(case_text("ball-on-beam", text + " | [contact] samples = 0"))
    names = ["speed", "ball.radius", "ball.lods", "beam.loss_factor", "contact.samples", "spede"]
    assert sorted(error.partition(": ")[0] for error in errors) == sorted(names)


@pytest.mark.parametrize(("kind", "message"), [
    ("", "kind: received nothing"),
    ('kind = "wheel-on-rial"', 'Did you mean "wheel-on-rail"?'),
    ("kind = 3", 'kind: received 3; allowed: "ball-on-beam"'),
])  # fmt: skip
def test_a_kind_that_is_none_is_the_only_error(kind, message):
    (error,) = errors_of(f'{kind}\n[surface]\nrms = "1 um"')
    assert message in error


def test_text_that_is_no_toml_is_named_with_its_line():
    with pytest.raises(InputError, match=r"case\.toml: received no TOML .*line 3"):
        parse_case('kind = "ball-on-beam"\n[surface]\nrms = 0.5 um', "case.toml")


def test_a_file_that_is_too_large_for_a_case_is_named(tmp_path):
    (tmp_path / "case.toml").write_bytes(b"#" * 2**21)
    with pytest.raises(InputError, match=r"case\.toml: .*more than 1 MiB"):
        read_case(tmp_path / "case.toml")
