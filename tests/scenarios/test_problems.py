"""What a run would refuse of a legal case, the check refuses before: by the key that it is about."""

import numpy as np
import pytest

import small_cases
from asperity import Track
from asperity.case.any_case import entries
from asperity.case.cases import as_case, case_class
from asperity.errors import CaseError, InputError
from asperity.running import prepare_case
from asperity.scenarios import preparing, reducing
from asperity.structures.moving_kernel import refuse_kernel
from command_line import call

BALL, BEARING = small_cases.BALL, small_cases.BEARING
WHEEL = small_cases.HEARD | {"kind": "wheel-on-rail", "laws": ["hertz"], "surface": {"smooth": True}}
WHEEL |= {"duration": "20 ms", "settling": "10 ms"}
MANY_BAYS = {"track": {"bays": 100, "pad_scatter": 0.2}, "contact": {"spacing": "0.5 mm"}}
REFUSED = {
    "surface.joint_depth": BALL | {"surface": {"joint_depth": "1 mm", "joint_length": "1 mm"}},
    "surface.rms": BALL | {"surface": {"rms": "100 um", "longest": "0.4 mm", "shortest": "60 um"}},
    "surface.corrugation": BALL | {"surface": {"corrugation": "25 um", "corrugation_wavelength": "60 um"}},
    "surface.corrugation_wavelength": BALL
    | {"surface": {"corrugation": "1 um", "corrugation_wavelength": "40 um"}},
    "ball.load": BALL | {"ball": {"load": "30 MN"}},
    "ball.flat_length": BALL | {"ball": {"flat_depth": "0.2 mm", "flat_length": "20 mm"}},
    "beam.width": BALL | {"beam": {"width": "20 um"}},
    "beam.modes_up_to": BALL | {"beam": {"modes_up_to": "20 Hz"}},
    "beam.supports": BALL | {"beam": {"supports": ["0.4 mm", "0.8 mm"]}},
    "numerics.highest_frequency": BALL | {"beam": {"height": "9 m"}},
    "contact.hardness": BALL | {"contact": BALL["contact"] | {"hardness": "0.1 GPa"}},
    "contact.sample_length": BALL | {"contact": BALL["contact"] | {"sample_length": "1 mm"}},
    "track.bays": WHEEL | MANY_BAYS | {"numerics": {"highest_frequency": "40 kHz", "kernel": "scatter"}},
    "radial": BEARING | {"radial": "100 kN"},
    "axial": BEARING | {"radial": "0 N", "axial": "1 MN"},
    "outer_raceway.waviness": BEARING | {"outer_raceway": {"waviness": "0.2 mm"}},
    "inner_raceway.last_order": BEARING | {"inner_raceway": {"waviness": "1 um", "last_order": 100_000}},
    "balls.roughness": BEARING | {"balls": {"roughness": "90 um"}},
    "fault.length": BEARING | {"fault": BEARING["fault"] | {"length": "0.2 m"}},
    "fault.offset": BEARING | {"fault": BEARING["fault"] | {"offset": "9 mm"}},
}


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize("key", REFUSED)
def test_what_a_run_would_refuse_is_refused_before_by_its_key(key):
    """Whether keys do not fit together, parts cannot be built, or what is built cannot be rolled."""
    keys = REFUSED[key]
    with pytest.raises(InputError) as caught:
        prepare_case(as_case(keys))
    error = caught.value
    told = error.errors[0] if isinstance(error, CaseError) else str(error)
    assert told.startswith(f"{key}: received "), told
    assert key in {entry.dotted for entry in entries(case_class(keys["kind"]))}


def test_the_command_refuses_with_exit_code_2_and_writes_nothing(tmp_path):
    case = as_case(REFUSED["track.bays"])
    (tmp_path / "case.toml").write_text(case.to_toml())
    said = call("check", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out"), code=2)
    assert not (tmp_path / "out").exists()
    assert "track.bays: received 100, for a kernel of 120 ms" in " ".join(said.stderr.split())


def test_waves_that_die_away_within_a_bay_are_known_before_the_kernel_is_computed():
    """Of Euler-Bernoulli's rail, (m ω²/B)^(1/4) L = 200 at the highest frequency of the transform, 2/h."""
    track = Track.named("nordborg")
    wavenumber = 200.0 / track.sleeper_spacing
    highest = wavenumber**2 * (track.bending_stiffness / track.mass_per_length) ** 0.5 / 6.283185307
    refuse_kernel(track, 2.0 / (0.5 * highest))
    with pytest.raises(InputError, match="decay of a rail wave over one bay"):
        refuse_kernel(track, 2.0 / (1.1 * highest))


def test_states_that_do_not_rise_are_refused_by_the_check_as_by_the_run(monkeypatch):
    prepared = prepare_case(as_case(BALL))
    monkeypatch.setattr(reducing, "chosen_states", lambda *_: np.array([2e-6, 1e-6, 3e-6]))
    told = r"surface: .*um rms, with first touch at 2 um.*small against"
    with pytest.raises(InputError, match=told):
        preparing.expect(prepared, lambda *_: None)
    with pytest.raises(InputError, match=told):
        reducing.reduce(prepared, None, lambda *_: None)
