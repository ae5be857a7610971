"""Batches of contacts against contacts solved one by one; on a GPU too, where there is one."""

import os
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from asperity.cli import main
from asperity.contact import HalfSpace, Hertz
from asperity.contact.batched import choose_device, find_device, gpu, processor, solve_batched
from asperity.contact.scan import ScanJob, scan_forces
from asperity.errors import ComputationError, InputError
from asperity.kernels.batched import convolve_padded, padded_spectrum
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

MODULUS, RADIUS = 115e9, 25e-3
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)
APPROACH = HERTZ.approach(10.0)
POSITIONS = 21


class OnDevice(np.ndarray):
    """An array that, as one on a GPU, does not mix with the processor's."""

    @classmethod
    def plain(cls, value):
        """What numpy is to work on in its place."""
        if isinstance(value, (list, tuple)):
            return type(value)(map(cls.plain, value))
        if type(value) is np.ndarray and value.ndim:
            raise TypeError("an array of the processor met one of the device")
        return value.view(np.ndarray) if isinstance(value, cls) else value

    def __array_ufunc__(self, ufunc, method, *inputs, out=(), **options):
        options |= {"out": self.plain(out)} if out else {}
        return on_device(getattr(ufunc, method)(*self.plain(inputs), **options))

    def __array_function__(self, function, types, arguments, options):
        return on_device(function(*self.plain(arguments), **options))

    def __getitem__(self, index):
        return on_device(self.view(np.ndarray)[self.plain(index)])

    def __setitem__(self, index, value):
        self.view(np.ndarray)[self.plain(index)] = self.plain(value)


def on_device(value):
    return value.view(OnDevice) if isinstance(value, np.ndarray) else value


class StrictModule:
    """The functions of numpy that batches use, all of which CuPy has, with arrays of a device of its own."""

    NAMES = (
        "abs", "arange", "argsort", "asarray", "ascontiguousarray", "clip", "maximum", "minimum", "ones",
        "sqrt", "where", "zeros", "zeros_like",
    )  # fmt: skip

    def __init__(self, largest_batch=10**6):
        self.largest_batch, self.fft = largest_batch, SimpleNamespace(rfft2=self.rfft2, irfft2=np.fft.irfft2)

    def __getattr__(self, name):
        assert name in self.NAMES
        return lambda *arguments, **options: on_device(getattr(np, name)(*arguments, **options))

    def rfft2(self, field, s):
        if len(field) > self.largest_batch:
            raise MemoryError
        return np.fft.rfft2(field, s=s)


def strict_device(**limits):
    return replace(processor(), xp=StrictModule(**limits), to_host=lambda a: np.array(a))


@pytest.fixture(params=["strict numpy", "gpu"])
def device(request):
    if request.param == "gpu":
        try:
            return gpu()
        except InputError as reason:
            pytest.skip(str(reason))
    return strict_device()


def rolling(n, hardness=None, share=0.35, stride=3):
    """A ball over a rough surface: the half-space, the surface, and the ball."""
    radius = HERTZ.semi_axes(APPROACH)[0]
    dx = 2 * radius / share / n
    x = (np.arange(n) - n // 2) * dx
    heights = self_affine(
        (n + stride * (POSITIONS - 1), n), (dx, dx), rms=0.1 * APPROACH, hurst=0.8, longest=1.4 * radius,
        shortest=max(0.36 * radius, 2.5 * dx), seed=1,
    ).heights  # fmt: skip
    return HalfSpace((n, n), (dx, dx), MODULUS, hardness), heights, np.add.outer(x**2, x**2) / (2 * RADIUS)


def problem(*details):
    """Its half-space and the gaps of all positions."""
    half_space, heights, body = rolling(*details)
    return half_space, np.stack([body - heights[3 * m : 3 * m + len(body)] for m in range(POSITIONS)])


def batched(half_space, gaps, approaches, device):
    def some(first, last):
        return device.xp.asarray(gaps[first:last])

    return solve_batched(half_space, some, len(gaps), np.asarray(approaches), 1e-11, device)


@pytest.mark.parametrize(
    ("n", "hardness", "share"), [(32, None, 0.35), (32, 0.5e9, 0.35), (64, None, 0.35), (32, None, 1.4)]
)
def test_contacts_agree_with_those_solved_one_by_one(device, n, hardness, share):
    """From none, over those that graze while their neighbours do not, to deep ones; the last are cut off."""
    half_space, gaps = problem(n, hardness, share)
    touch = np.sort(gaps.min(axis=(1, 2)))
    grazing = touch[POSITIONS // 2] + np.array([1e-15, 1e-12])
    approaches = [touch[0] - 1e-9, *grazing, *(APPROACH * np.array([0.0, 0.3, 1.0]))]
    found = batched(half_space, gaps, approaches, device)
    assert found.converged.all()
    assert not found.force[0].any()
    assert not found.iterations[0].any()
    assert 0 < np.count_nonzero(found.force[1]) < POSITIONS
    for m in range(0, POSITIONS, 4):
        for i, approach in enumerate(approaches):
            alone = half_space.solve(gaps[m], approach=float(approach), rtol=1e-11)
            assert found.force[i, m] == pytest.approx(alone.force, rel=1e-9, abs=0.0)
            assert found.edge_share[i, m] == pytest.approx(alone.edge_share, rel=1e-8)
        assert (alone.edge_share > 0.1) == (share > 1.0)
        assert hardness is None or alone.pressure.max() == hardness


def test_batches_follow_the_memory_and_do_not_change_the_forces():
    half_space, gaps = problem(32)
    asked, approaches = [], APPROACH * np.array([0.0, 0.5, 1.0])

    def some(first, last):
        asked.append(last - first)
        return gaps[first:last]

    whole = solve_batched(half_space, some, POSITIONS, approaches, 1e-11, processor())
    parts = solve_batched(half_space, some, POSITIONS, approaches, 1e-11, processor(memory=2**21))
    assert asked[0] == POSITIONS
    assert max(asked[1:]) < POSITIONS / 2
    np.testing.assert_allclose(parts.force, whole.force, rtol=1e-12)
    shrunk = batched(half_space, gaps, approaches, strict_device(largest_batch=4))
    np.testing.assert_allclose(shrunk.force, whole.force, rtol=1e-12)
    with pytest.raises(ComputationError, match=r"one contact of .* ran out of memory.*Try: a smaller window"):
        batched(half_space, gaps, approaches, strict_device(largest_batch=0))


def test_what_does_not_converge_is_told(monkeypatch):
    half_space, gaps = problem(32)
    monkeypatch.setattr("asperity.contact.batched.MAX_ITERATIONS", 5)
    found = batched(half_space, gaps, [APPROACH], strict_device())
    assert not found.converged.any()
    assert np.all(found.iterations == 5)


def test_convolution_is_the_double_sum():
    rng = np.random.default_rng(0)
    table, field = rng.standard_normal((6, 5)), rng.standard_normal((3, 6, 5))
    found = convolve_padded(field, padded_spectrum(table, 6, 5), np)
    i, j = np.arange(6), np.arange(5)
    kernel = table[abs(i[:, None] - i)[:, None, :, None], abs(j[:, None] - j)[None, :, None, :]]
    np.testing.assert_allclose(found, np.einsum("ijkl,bkl->bij", kernel, field), atol=1e-12)


@pytest.mark.parametrize(("n", "share", "stride"), [(32, 0.35, 1), (32, 0.35, 3), (16, 1.4, 2)])
def test_a_scan_on_a_device_agrees_and_keeps_its_own_blocks(device, monkeypatch, n, share, stride):
    """The window of 16 cells cuts the contact off; blocks of the device are not taken for the processor's."""
    monkeypatch.setattr("asperity.contact.scan.BATCH", 8)
    half_space, heights, body = rolling(n, None, share, stride)
    planes = 0.1 * APPROACH * np.sin(np.arange(POSITIONS))
    approaches = APPROACH * np.array([-0.2, 0.3, 1.0])
    job = ScanJob(half_space, Rows(heights), body, approaches, stride, 1e-11, planes, device=None)
    kept = {}
    cache = SimpleNamespace(get=kept.get, put=kept.__setitem__)
    alone = scan_forces(job, cache=cache)
    for _ in range(2):
        found = scan_forces(replace(job, device=device), cache=cache)
        np.testing.assert_allclose(found.forces, alone.forces, rtol=1e-9)
        assert found.counts._replace(iterations=0) == alone.counts._replace(iterations=0)
        assert found.counts.iterations > 0
        assert len(kept) == 1 + 3
    assert bool(alone.counts.truncated) == (share > 1.0)


def no_device():
    raise RuntimeError("cudaErrorNoDevice: no CUDA-capable device is detected\nmore")


@pytest.mark.parametrize(
    ("cupy", "message"),
    [
        (None, r"no CuPy .*pip install 'asperity\[gpu\]'"),
        (
            SimpleNamespace(cuda=SimpleNamespace(runtime=SimpleNamespace(getDeviceCount=no_device))),
            r"no usable CUDA device \(cudaErrorNoDevice: .* detected\); .*nvidia-smi",
        ),
    ],
)
def test_a_gpu_that_is_not_there_is_refused(monkeypatch, cupy, message):
    monkeypatch.setitem(sys.modules, "cupy", cupy)
    monkeypatch.setenv("ASPERITY_DEVICE", "cpu")
    with pytest.raises(InputError, match=message):
        find_device("gpu")
    outcome = CliRunner().invoke(main, ["run", "case.toml", "--device", "gpu"])
    assert outcome.exit_code == 2
    assert 'device "gpu": received no' in outcome.output
    assert os.environ["ASPERITY_DEVICE"] == "cpu"


def test_the_device_is_named_or_that_of_the_environment(monkeypatch):
    monkeypatch.setenv("ASPERITY_DEVICE", "GPU")
    with pytest.raises(InputError, match=r"\$ASPERITY_DEVICE: received 'GPU'; allowed: 'cpu' or 'gpu'"):
        find_device()
    with pytest.raises(InputError, match="device: received 'tpu'; allowed: 'cpu' or 'gpu'"):
        HalfSpace((4, 4), 1.0, 1.0).scan(np.zeros((4, 4)), np.zeros((4, 4)), [0.0], device="tpu")
    choose_device("cpu")
    assert os.environ["ASPERITY_DEVICE"] == "cpu"
    assert find_device() is None
