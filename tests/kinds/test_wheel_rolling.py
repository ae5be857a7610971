"""A wheel rolling on a track: steady loads, closed forms, the frequency domain, convergence, flights."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.errors import CoarseSamplingWarning, InputError
from asperity.laws import HertzLaw, Linear
from asperity.radiation.passing import _Path, passed_points
from asperity.reduction.texture import StateTexture
from asperity.reference import cnossos
from asperity.scenarios.linear_force import linear_force_psd
from asperity.spectra import band_levels, psd
from asperity.store import Checkpoint, Store
from asperity.structures.moving_kernel import HatResponse, moving_kernel
from asperity.structures.rail_poles import rail_poles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel
from asperity.surfaces.synthesis import from_bands
from one_contact import roll_wheel

SPEED, STEP = 56.0, 50e-6
TRACK = Track(
    bending_stiffness=4.725e6,
    mass_per_length=60.0,
    rail_loss_factor=0.004,
    pad_stiffness=300e6,
    pad_damping=18e3,
    sleeper_mass=150.0,
    ballast_stiffness=150e6,
    ballast_damping=48e3,
    sleeper_spacing=0.6,
)
LOAD, MASS, HERTZ = 65e3, 600.0, 9.413e10
APPROACH = (LOAD / HERTZ) ** (2 / 3)
STIFFNESS = 1.5 * HERTZ * np.sqrt(APPROACH)
WHEEL = Wheel(MASS, LOAD)


@pytest.fixture(scope="module")
def kernel():
    return moving_kernel(TRACK, SPEED, STEP)


@pytest.fixture(scope="module")
def poles(kernel):
    return rail_poles(kernel, 100)


def roughness(level, duration, seed=5, speed=SPEED):
    wavelengths, levels = (v[7:29] for v in cnossos.rail_roughness("iso3095"))
    line = from_bands(round(speed * duration / 1e-3), 1e-3, wavelengths, levels + level, seed).heights
    return StateTexture.unfiltered(-line, 1e-3, -0.4 * speed)


def linear(texture=None):
    return Linear(LOAD, STIFFNESS, APPROACH, texture)


class TestSmoothRail:
    def test_the_mean_force_is_the_load_and_tones_lie_at_the_sleeper_passing_frequency(self, poles):
        run = roll_wheel(poles, WHEEL, HertzLaw(HERTZ), start=0.0, duration=1.5, settling=1.0)
        # 140 sleepers are passed in 1.5 s at 56 m/s
        samples = len(run.contact_force) - 1
        spectrum = np.abs(np.fft.rfft(run.contact_force[:samples])) / samples
        passing = round(1.5 * SPEED / 0.6)
        assert run.contact_force.mean() == pytest.approx(LOAD, rel=2e-4)
        tones = np.arange(passing, len(spectrum), passing)
        assert spectrum[passing] > 100.0
        power = np.sum(spectrum[1:] ** 2)
        assert np.sum(spectrum[tones] ** 2) > 0.9999 * power

    def test_without_a_run_in_it_starts_steady(self, poles):
        run = roll_wheel(poles, WHEEL, HertzLaw(HERTZ), start=0.1, duration=0.02, settling=0.0)
        assert run.contact_force[0] == LOAD
        assert np.abs(run.contact_force[:20] / LOAD - 1.0).max() < 0.01
        steady = roll_wheel(poles, WHEEL, HertzLaw(HERTZ), start=0.1, duration=0.02, settling=1.0)
        assert run.over_displacement[0] == pytest.approx(steady.over_displacement[0], rel=0.03)


class TestPolesAgainstScatter:
    def test_force_in_time_and_in_bands(self, kernel, poles):
        texture = roughness(0.0, 2.0)
        runs = [
            roll_wheel(rail, WHEEL, HertzLaw(HERTZ, texture), start=0.0, duration=1.0, settling=0.3)
            for rail in (poles, kernel)
        ]
        fitted, scattered = (run.contact_force for run in runs)
        assert np.std(fitted - scattered) < 0.005 * np.std(scattered)
        frequency, density = psd(np.stack([fitted, scattered]), STEP, segment=8000)
        _, levels = band_levels(frequency, density, low=31.5, high=5000.0)
        assert np.abs(levels[0] - levels[1]).max() < 0.05


class TestAgainstTheFrequencyDomain:
    def test_linear_contact_within_one_decibel(self):
        step = 25e-6
        rail = rail_poles(moving_kernel(TRACK, SPEED, step), 100)
        texture = roughness(0.0, 6.5)
        run = roll_wheel(rail, WHEEL, linear(texture), start=0.0, duration=6.0, settling=0.4)
        segment = 16000
        frequency, found = psd(run.contact_force, step, segment=segment)
        heard = texture.at(run.position)[:, 0]
        _, density = psd(heard, SPEED * step, segment=segment)
        expected = np.zeros_like(found)
        expected[1:] = linear_force_psd(frequency[1:], density[1:], SPEED, WHEEL, TRACK, STIFFNESS)
        band, levels = band_levels(frequency, np.stack([found, expected]), low=125.0, high=4000.0)
        pinned = TRACK.pinned_pinned_frequency
        away = np.abs(np.log10(band / pinned)) > 0.08  # the bands of the pinned–pinned peak and its split
        difference = (levels[0] - levels[1])[away]
        assert away.sum() >= 13
        assert np.abs(difference).max() < 1.0

    def test_loss_factors_keep_the_force_at_the_resonance_of_the_wheel_on_the_track(self):
        track, speed = Track.named("nordborg-loss-factor"), 10.0
        rail = rail_poles(moving_kernel(track, speed, STEP, positions=12), 100)
        heights = 1e-8 * np.cumsum(np.random.default_rng(3).standard_normal(25_000))
        texture = StateTexture.unfiltered(-(heights - heights.mean()), 2e-3, -5.0)
        rough, smooth = (
            roll_wheel(rail, WHEEL, linear(each), start=0.0, duration=4.0, settling=0.4)
            for each in (texture, None)
        )
        # the contact is linear: without the tones of the sleepers, the force is that of the texture
        frequency, found = psd(rough.contact_force - smooth.contact_force, STEP, segment=20_000)
        _, density = psd(texture.at(rough.position)[:, 0], speed * STEP, segment=20_000)
        expected = np.zeros_like(found)
        expected[1:] = linear_force_psd(frequency[1:], density[1:], speed, WHEEL, track, STIFFNESS)
        _, levels = band_levels(frequency, np.stack([found, expected]), low=25.0, high=1000.0)
        assert np.abs(levels[0] - levels[1]).max() < 0.75


class TestConvergence:
    def test_the_force_converges_with_the_square_of_the_time_step(self):
        x = np.arange(0.0, 9.0, 1e-3)
        texture = StateTexture.unfiltered(-10e-6 * np.sin(2 * np.pi * x / 0.2), 1e-3, -6.0)
        forces = []
        for divide in (1, 2, 4):
            step = 8e-5 / divide
            rail = moving_kernel(TRACK, SPEED, step, duration=0.2)
            run = roll_wheel(rail, WHEEL, HertzLaw(HERTZ, texture), start=0.0, duration=0.048, settling=0.096)
            forces.append(run.contact_force[::divide])
        n = min(map(len, forces))
        coarse = np.linalg.norm(forces[0][:n] - forces[1][:n])
        fine = np.linalg.norm(forces[1][:n] - forces[2][:n])
        assert 1.7 < np.log2(coarse / fine) < 2.4


class TestWheel:
    def test_a_flexible_wheel_follows_its_receptance(self, poles):
        # a mode far below the contact resonance of the rail: the force dips where wheel and rail balance
        wheel = Wheel(MASS, LOAD, [1800.0], [0.005], [40.0])
        texture = roughness(0.0, 2.0)
        run = roll_wheel(poles, wheel, linear(texture), start=0.0, duration=1.2, settling=0.4)
        rigid = roll_wheel(poles, WHEEL, linear(texture), start=0.0, duration=1.2, settling=0.4)
        frequency, density = psd(np.stack([run.contact_force, rigid.contact_force]), STEP, segment=4000)
        _, heard = psd(texture.at(run.position)[:, 0], SPEED * STEP, segment=4000)
        expected = [
            linear_force_psd(frequency[1:], heard[1:], SPEED, w, TRACK, STIFFNESS) for w in (wheel, WHEEL)
        ]
        _, levels = band_levels(frequency, density, low=1250.0, high=2500.0)
        _, theory = band_levels(frequency[1:], np.stack(expected), low=1250.0, high=2500.0)
        change, predicted = levels[0] - levels[1], theory[0] - theory[1]
        assert np.abs(predicted).max() > 3.0
        np.testing.assert_allclose(change, predicted, atol=0.7)
        assert run.contact_force.mean() == pytest.approx(LOAD, rel=2e-3)


class TestFlight:
    def test_loss_of_contact_grows_with_roughness(self, poles):
        shares = []
        for level in (10.0, 15.0, 20.0):
            texture = roughness(level, 2.5)
            run = roll_wheel(poles, WHEEL, HertzLaw(HERTZ, texture), start=0.0, duration=2.0, settling=0.3)
            shares.append(run.contact_loss_share)
            assert (run.contact_force >= 0.0).all()
            assert sum(e.duration for e in run.contact_loss) == pytest.approx(
                run.contact_loss_share * len(run.time) * STEP
            )
        assert shares[0] < 1e-3
        assert 2e-3 < shares[1] < 0.04
        assert 0.08 < shares[2] < 0.2


class TestPassedPoints:
    def test_a_point_moves_with_the_contact_when_it_is_passed(self, kernel, poles):
        texture = roughness(0.0, 1.2)
        run = roll_wheel(kernel, WHEEL, linear(texture), start=0.0, duration=0.6, settling=0.2)
        points = np.array([16.2, 16.5, 16.61])
        history, origin = run.history, run.history_start[0]
        settled = history.shape[1] - len(run.time)
        displacement, velocity = passed_points(kernel, history, origin, points, settled)
        for i, x in enumerate(points):
            at_point = np.interp(x, run.position, displacement[0, i])
            assert at_point == pytest.approx(np.interp(x, run.position, run.over_displacement), rel=1e-3)
        middle = 0.5 * (displacement[0, :, 2:] - displacement[0, :, :-2]) / STEP
        error = np.std(velocity[0, :, 1:-1] - middle) / np.std(middle)
        assert error < 0.1  # second against sixth order
        far = passed_points(kernel, history, origin, [16.2 + 300.0])[0]
        assert np.abs(far).max() < 1e-3 * np.abs(displacement).max()

    @pytest.mark.parametrize(
        ("struck", "stride", "steps"),
        [(-1.23, 1.5e-3, 5000), (1.47, 1.5e-3, 5000), (2.999, 1.4e-3, 5000), (1.47, 1.5e-3, 90)],
    )
    def test_a_blow_some_bays_away_is_felt_as_the_receptance_has_it(self, struck, stride, steps):
        """One step of force at a place that is no node: the transform of hat times receptance."""
        step, point = stride / SPEED, 0.13
        rail = moving_kernel(TRACK, SPEED, step, duration=0.12, positions=4)
        history = np.zeros(steps)
        history[10] = 1.0
        displacement, _ = passed_points(rail, history[None], struck - 10 * stride, [point])
        taps = rail.weights.shape[1]
        grid = HatResponse(rail.track, step, 3 * taps, 1)
        receptance = grid.waves.receptance(point + 6.0, struck + 6.0)
        expected = grid.response((grid.hat * receptance)[None])[0, : min(steps - 10, taps // 2)]
        found = displacement[0, 0, 10 : 10 + len(expected)]
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())

    def test_a_steady_load_makes_no_sound_when_steps_end_on_sleepers(self):
        """A step that counted twice, or not at all, would hit the rail with 65 kN."""
        step = 0.6 / 400 / SPEED
        rail = moving_kernel(TRACK, SPEED, step, duration=0.12, positions=4)
        for start in (-16.8, 0.1):
            _, velocity = passed_points(rail, np.full((1, 9000), LOAD), start, [start + 6.6, start + 6.9])
            heard = velocity[0][:, 3000:] * np.hanning(6000)  # the load is there at once at first
            spectrum = np.abs(np.fft.rfft(heard, axis=1)) ** 2
            frequency = np.fft.rfftfreq(6000, step)
            high = (frequency > 2000.0) & (frequency < 5000.0)
            assert spectrum[:, high].sum() < 1e-6 * spectrum.sum()

    @given(st.floats(-50.0, 50.0), st.integers(1, 4000), st.floats(1e-4, 3.0))
    def test_every_step_lies_in_one_bay(self, first, steps, stride):
        path = _Path(np.zeros((1, steps)), first, stride)
        pieces = [path.within(bay) for bay in path.bays]
        assert [begin for begin, *_ in pieces] == list(np.cumsum([0, *(len(p[2]) for p in pieces)])[:-1])
        places = np.concatenate([places for *_, places in pieces])
        assert len(places) == steps
        assert places.min() > -1e-9
        assert places.max() < 1.0 + 1e-9

    def test_points_must_be_finite(self, kernel):
        with pytest.raises(InputError, match="points on the rail"):
            passed_points(kernel, np.zeros((1, 9)), 0.0, [np.nan])


class TestCheckpoint:
    def test_an_interrupted_run_goes_on_bit_by_bit(self, poles, monkeypatch, tmp_path):
        texture = roughness(0.0, 1.0)
        law = HertzLaw(HERTZ, texture)
        settings = {"start": 0.0, "duration": 0.1, "settling": 0.1}
        whole = roll_wheel(poles, WHEEL, law, **settings)
        kept = Checkpoint(Store(tmp_path), "run")
        monkeypatch.setattr("asperity.rolling.stepper.LONGEST", 700)

        def stop(done, total, message):
            if done >= 1400:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            roll_wheel(poles, WHEEL, law, **settings, checkpoint=kept, progress=stop)
        assert kept.load()["motion.counts"][0] == 1400
        resumed = roll_wheel(poles, WHEEL, law, **settings, checkpoint=kept)
        np.testing.assert_array_equal(resumed.contact_force, whole.contact_force)
        with pytest.raises(InputError, match="checkpoint"):
            roll_wheel(poles, WHEEL, law, start=0.0, duration=0.01, settling=0.0, checkpoint=kept)


class TestBadInput:
    @pytest.mark.parametrize(
        ("settings", "message"),
        [
            ({"duration": 0.0}, "duration"),
            ({"duration": 1e-6}, "at least one time step"),
            ({"settling": -1.0}, "settling"),
        ],
    )
    def test_numbers(self, poles, settings, message):
        with pytest.raises(InputError, match=message):
            roll_wheel(
                poles, WHEEL, HertzLaw(HERTZ), **{"start": 0.0, "duration": 0.1, "settling": 0.0} | settings
            )

    def test_a_coarse_time_step_is_warned_of(self, poles):
        with pytest.warns(CoarseSamplingWarning, match="highest frequency asked for, 8000 Hz"):
            roll_wheel(
                poles,
                WHEEL,
                HertzLaw(HERTZ),
                start=0.0,
                duration=0.01,
                settling=0.0,
                highest_frequency=8000.0,
            )
