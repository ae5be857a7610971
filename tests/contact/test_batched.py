"""Batches of contacts against contacts solved one by one; on a GPU too, where there is one."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from asperity.contact import HalfSpace, Hertz
from asperity.contact.batched import find_device, gpu, processor, solve_batched
from asperity.errors import ComputationError, InputError
from asperity.kernels.convolution import convolve_padded, padded_length, padded_spectrum
from asperity.surfaces.synthesis import self_affine

MODULUS = 115e9
RADIUS = 25e-3
LOAD = 10.0
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)
APPROACH = HERTZ.approach(LOAD)
POSITIONS = 21


class OnDevice(np.ndarray):
    """An array that, as one on a GPU, does not mix with the processor's."""

    @staticmethod
    def check(values):
        for value in values:
            if isinstance(value, (list, tuple)):
                OnDevice.check(value)
            elif type(value) is np.ndarray and value.ndim:
                raise TypeError("an array of the processor met one of the device")

    def __array_ufunc__(self, ufunc, method, *inputs, out=(), **options):
        self.check([*inputs, *out])
        plain = [np.asarray(v) if isinstance(v, OnDevice) else v for v in inputs]
        if out:
            options["out"] = tuple(np.asarray(v) for v in out)
        return on_device(getattr(ufunc, method)(*plain, **options))

    def __getitem__(self, index):
        self.check([index])
        return super().__getitem__(index)

    def __setitem__(self, index, value):
        self.check([index, value])
        super().__setitem__(index, value)


def on_device(value):
    return value.view(OnDevice) if isinstance(value, np.ndarray) else value


class StrictModule:
    """The functions of numpy that batches use, all of which CuPy has, on arrays of a device of its own."""

    MAKING = ("arange", "asarray", "ones", "zeros")
    USING = (
        "abs", "ascontiguousarray", "clip", "concatenate", "maximum", "minimum", "nonzero", "sqrt", "where",
        "zeros_like",
    )  # fmt: skip
    int64 = np.int64

    def __init__(self, largest_batch=10**6):
        self.largest_batch = largest_batch
        self.fft = SimpleNamespace(rfft2=self.rfft2, irfft2=self.guarded(np.fft.irfft2))

    def __getattr__(self, name):
        if name in self.MAKING:
            return lambda *a, **k: on_device(getattr(np, name)(*a, **k))
        if name in self.USING:
            return self.guarded(getattr(np, name))
        raise AttributeError(name)

    def rfft2(self, field, s):
        if len(field) > self.largest_batch:
            raise MemoryError
        return self.guarded(np.fft.rfft2)(field, s=s)

    @staticmethod
    def guarded(function):
        def call(*arguments, **options):
            OnDevice.check(arguments)
            found = function(*arguments, **options)
            return tuple(map(on_device, found)) if isinstance(found, tuple) else on_device(found)

        return call


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


def problem(n, hardness=None, seed=1, share=0.35):
    """A ball over a rough surface: half-space, gaps of all positions, and their maker."""
    radius = HERTZ.semi_axes(APPROACH)[0]
    dx = 2 * radius / share / n
    x = (np.arange(n) - n // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    heights = self_affine(
        (n + 3 * POSITIONS, n), (dx, dx), rms=0.1 * APPROACH, hurst=0.8, longest=1.4 * radius,
        shortest=max(0.36 * radius, 2.5 * dx), seed=seed,
    ).heights  # fmt: skip
    gaps = np.stack([body - heights[3 * m : 3 * m + n] for m in range(POSITIONS)])
    return HalfSpace((n, n), (dx, dx), MODULUS, hardness), gaps


def batched(half_space, gaps, approaches, device, rtol=1e-11):
    def some(first, last):
        return device.xp.asarray(gaps[first:last])

    return solve_batched(half_space, some, len(gaps), np.asarray(approaches), rtol, device)


@pytest.mark.parametrize("hardness", [None, 0.5e9])
@pytest.mark.parametrize("n", [32, 64])
def test_forces_agree_with_contacts_solved_one_by_one(device, n, hardness):
    half_space, gaps = problem(n, hardness)
    approaches = APPROACH * np.array([-0.4, -0.1, 0.0, 0.3, 1.0])
    found = batched(half_space, gaps, approaches, device)
    assert found.converged.all()
    for m in range(0, POSITIONS, 4):
        for i, approach in enumerate(approaches):
            alone = half_space.solve(gaps[m], approach=float(approach), rtol=1e-11)
            assert found.force[i, m] == pytest.approx(alone.force, rel=1e-9, abs=0.0)
            if hardness is not None and i == len(approaches) - 1:
                assert alone.pressure.max() == hardness


def test_grazing_contact(device):
    """One position barely touches, its neighbours do not or do more: all agree with single contacts."""
    half_space, gaps = problem(32)
    touch = np.sort(gaps.min(axis=(1, 2)))[POSITIONS // 2]
    approaches = touch + np.array([1e-15, 1e-12, 1e-10])
    found = batched(half_space, gaps, approaches, device)
    assert 0 < np.count_nonzero(found.force[0]) < POSITIONS
    for m in range(POSITIONS):
        for i, approach in enumerate(approaches):
            alone = half_space.solve(gaps[m], approach=float(approach), rtol=1e-11).force
            assert found.force[i, m] == pytest.approx(alone, rel=1e-9, abs=0.0)


def test_smooth_ball_is_hertz(device):
    half_space, gaps = problem(64)
    x = np.arange(-32, 32) * half_space.spacing[0]
    smooth = np.broadcast_to((x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS), gaps.shape)
    found = batched(half_space, smooth, [0.5 * APPROACH, APPROACH], device)
    np.testing.assert_allclose(found.force[1], LOAD, rtol=2e-3)
    np.testing.assert_allclose(found.force[0], HERTZ.force(0.5 * APPROACH), rtol=4e-3)
    assert np.all(found.edge_share == 0.0)


def test_cut_off_contact_has_force_on_the_edge(device):
    half_space, gaps = problem(32, share=1.4)
    found = batched(half_space, gaps, [APPROACH], device)
    for m in (0, 7, 20):
        alone = half_space.solve(gaps[m], approach=APPROACH, rtol=1e-11)
        assert alone.edge_share > 0.1
        assert found.edge_share[0, m] == pytest.approx(alone.edge_share, rel=1e-8)


def test_apart_there_is_nothing(device):
    half_space, gaps = problem(32)
    found = batched(half_space, gaps, [gaps.min() - 1e-9, gaps.min()], device)
    assert not found.force.any()
    assert not found.iterations.any()
    assert found.converged.all()


def test_batches_follow_the_memory_and_do_not_change_the_forces():
    half_space, gaps = problem(32)
    approaches = APPROACH * np.array([0.0, 0.5, 1.0])
    asked = []

    def some(first, last):
        asked.append(last - first)
        return gaps[first:last]

    whole = solve_batched(half_space, some, POSITIONS, approaches, 1e-11, processor())
    assert set(asked) == {POSITIONS}
    asked.clear()
    parts = solve_batched(half_space, some, POSITIONS, approaches, 1e-11, processor(memory=2**21))
    assert max(asked[len(asked) // 2 :]) < POSITIONS / 2
    np.testing.assert_allclose(parts.force, whole.force, rtol=1e-12)


def test_batches_shrink_when_memory_runs_out():
    half_space, gaps = problem(32)
    whole = batched(half_space, gaps, [APPROACH], strict_device())
    parts = batched(half_space, gaps, [APPROACH], strict_device(largest_batch=4))
    np.testing.assert_allclose(parts.force, whole.force, rtol=1e-12)
    with pytest.raises(ComputationError, match=r"one contact of .* ran out of memory.*Try: a smaller window"):
        batched(half_space, gaps, [APPROACH], strict_device(largest_batch=0))


def test_what_does_not_converge_is_told(monkeypatch):
    half_space, gaps = problem(32)
    monkeypatch.setattr("asperity.contact.batched.MAX_ITERATIONS", 5)
    found = batched(half_space, gaps, [APPROACH], strict_device())
    assert not found.converged.any()
    assert np.all(found.iterations == 5)


def test_members_that_converge_early_stay_as_they_are():
    """Position 0 has few cells in contact, the others many: the batch goes on without it."""
    half_space, gaps = problem(32)
    gaps = np.concatenate([gaps[:1] + 0.95 * APPROACH, np.tile(gaps, (2, 1, 1))])
    found = batched(half_space, gaps, [APPROACH], strict_device())
    assert found.iterations[0, 0] < found.iterations[0, 1:].min()
    alone = half_space.solve(gaps[0], approach=APPROACH, rtol=1e-11).force
    assert found.force[0, 0] == pytest.approx(alone, rel=1e-9)


def test_batched_convolution_is_the_double_sum():
    rng = np.random.default_rng(0)
    table, field = rng.standard_normal((6, 5)), rng.standard_normal((3, 6, 5))
    found = convolve_padded(field, padded_spectrum(table, 6, 5), padded_length(5), np)
    i, j = np.arange(6), np.arange(5)
    kernel = table[abs(i[:, None] - i)[:, None, :, None], abs(j[:, None] - j)[None, :, None, :]]
    np.testing.assert_allclose(found, np.einsum("ijkl,bkl->bij", kernel, field), atol=1e-12)


def test_without_cupy_the_gpu_is_refused(monkeypatch):
    monkeypatch.setitem(sys.modules, "cupy", None)
    with pytest.raises(InputError, match=r"no CuPy .*pip install 'asperity\[gpu\]'") as caught:
        find_device("gpu")
    assert caught.value.exit_code == 2


def test_without_a_device_the_gpu_is_refused(monkeypatch):
    def count():
        raise RuntimeError("cudaErrorNoDevice: no CUDA-capable device is detected\nmore")

    fake = SimpleNamespace(cuda=SimpleNamespace(runtime=SimpleNamespace(getDeviceCount=count)))
    monkeypatch.setitem(sys.modules, "cupy", fake)
    with pytest.raises(
        InputError, match=r"no usable CUDA device \(cudaErrorNoDevice: .* detected\); .*nvidia-smi"
    ):
        find_device("gpu")


def test_the_processor_needs_no_batches_and_other_devices_are_unknown():
    assert find_device("cpu") is None
    with pytest.raises(InputError, match="'tpu'; allowed: 'cpu' or 'gpu'"):
        find_device("tpu")
