"""Batches of contacts against contacts solved one by one; on a GPU too, where there is one."""

import os
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from asperity import HalfSpace, Hertz
from asperity.cli import main
from asperity.contact.batched import choose_device, find_device, gpu, processor
from asperity.contact.scan import ScanJob, scan_forces
from asperity.errors import ComputationError, InputError
from asperity.kernels import batched
from asperity.kernels.box import box_room, empty_box
from asperity.kernels.lanes import aligned, width
from asperity.kernels.options import compiled
from asperity.kernels.projected_cg import precondition
from asperity.store import Store
from asperity.surfaces.edges import Edges
from asperity.surfaces.faults import Fault
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
        self.largest_batch, self.largest = largest_batch, 0
        self.fft = SimpleNamespace(rfft2=self.rfft2, irfft2=np.fft.irfft2)

    def __getattr__(self, name):
        assert name in self.NAMES
        return lambda *arguments, **options: on_device(getattr(np, name)(*arguments, **options))

    def rfft2(self, field, s):
        if len(field) > self.largest_batch:
            raise MemoryError
        self.largest = max(self.largest, len(field))
        return np.fft.rfft2(field, s=s)


def strict_device(memory=2**28, **limits):
    return replace(processor(memory), xp=StrictModule(**limits), to_host=lambda a: np.array(a))


@pytest.fixture(params=["strict numpy", "gpu"])
def device(request):
    if request.param == "gpu":
        try:
            return gpu()
        except InputError as reason:
            pytest.skip(str(reason))
    return strict_device()


def rolling(n, hardness=None, share=0.35, stride=3, **details):
    """Scan of a ball over a rough surface, from no contact at all to a deep one."""
    radius = HERTZ.semi_axes(APPROACH)[0]
    dx = 2 * radius / share / n
    x = (np.arange(n) - n // 2) * dx
    heights = self_affine(
        (n + stride * (POSITIONS - 1), n), (dx, dx), rms=0.1 * APPROACH, hurst=0.8, longest=1.4 * radius,
        shortest=max(0.36 * radius, 2.5 * dx), seed=1,
    ).heights  # fmt: skip
    body = np.add.outer(x**2, x**2) / (2 * RADIUS)
    touch = np.sort([(body - heights[m * stride :][:n]).min() for m in range(POSITIONS)])
    grazing = touch[POSITIONS // 2] + np.array([1e-15, 1e-12])  # while their neighbours do not
    approaches = [touch[0] - 1e-9, *grazing, *(APPROACH * np.array([0.0, 0.3, 1.0]))]
    space = HalfSpace((n, n), (dx, dx), MODULUS, hardness)
    return ScanJob(space, Rows(heights), body, approaches, stride, 1e-11, **{"device": None} | details)


@pytest.mark.parametrize(
    ("n", "hardness", "share", "stride"),
    [(32, None, 0.35, 1), (32, 0.5e9, 0.35, 3), (64, None, 0.35, 3), (16, None, 1.4, 2)],
)
def test_a_scan_on_a_device_agrees_and_keeps_its_own_blocks(
    device, tmp_path, monkeypatch, n, hardness, share, stride
):
    """The window of 16 cells cuts the contact off; blocks of the device are not taken for the processor's."""
    monkeypatch.setattr("asperity.contact.scan.BATCH", 8)
    planes, cache = 1e-3 * APPROACH * np.sin(np.arange(POSITIONS)), Store(tmp_path)
    job = rolling(n, hardness, share, stride, planes=planes)
    alone = scan_forces(job, cache=cache)
    for _ in range(2):
        found = scan_forces(replace(job, device=device), cache=cache)
        np.testing.assert_allclose(found.forces, alone.forces, rtol=1e-9)
        assert found.counts._replace(iterations=0) == alone.counts._replace(iterations=0)
        assert 0 < found.counts.iterations < 1.15 * alone.counts.iterations
        assert len(cache.files()) == 1 + 3
    assert bool(alone.counts.truncated) == (share > 1.0)
    assert 0 < np.count_nonzero(alone.forces[:3]) < 3 * POSITIONS


@pytest.mark.parametrize("hardness", [None, 0.5e9])
def test_sharp_edges_on_a_device_agree(device, hardness):
    """A deep pit, and a shallow one whose floor carries, too."""
    job = rolling(24, hardness, stride=4)
    (n, m), (dx, _) = job.surface.shape, job.half_space.spacing
    x, y = (np.arange(n) - 0.45 * n)[:, None] * dx, (np.arange(m) - 0.48 * m) * dx
    for depth in (1e-3, 0.1 * APPROACH):
        distance, normal = Fault("pit", length=5.3 * dx, depth=depth).outline(x, y)
        edges = Edges(distance, normal, np.full((n, m), 0.5 * depth), job.half_space.spacing)
        heights = job.surface.heights - np.where(edges.sound, 0.0, depth)
        sharp = replace(job, surface=Rows(heights), edges=edges)
        alone, found = (scan_forces(replace(sharp, device=each)) for each in (None, device))
        np.testing.assert_allclose(found.forces, alone.forces, rtol=1e-9)
        assert found.counts.unconverged == 0
        assert np.abs(scan_forces(job).forces[-1] / alone.forces[-1] - 1.0).max() > 1e-3


def test_batches_follow_the_memory_and_do_not_change_the_forces():
    job, sizes = rolling(32), []
    whole = scan_forces(replace(job, device=processor())).forces
    for device in (strict_device(), strict_device(memory=2**21), strict_device(largest_batch=4)):
        found = scan_forces(replace(job, device=device))
        np.testing.assert_allclose(found.forces, whole, rtol=1e-9)
        sizes.append(device.xp.largest)
    assert sizes[0] == POSITIONS
    assert sizes[1] < POSITIONS / 2
    assert sizes[2] <= 4
    with pytest.raises(ComputationError, match=r"one contact of .* ran out of memory.*Try: a smaller window"):
        scan_forces(replace(job, device=strict_device(largest_batch=0)))


def test_what_does_not_converge_is_told(monkeypatch):
    monkeypatch.setattr("asperity.contact.pressed.MAX_ITERATIONS", 5)
    counts = scan_forces(replace(rolling(32), approaches=[APPROACH], device=strict_device())).counts
    assert counts == (POSITIONS, 5 * POSITIONS, POSITIONS, 0)


def no_device():
    raise RuntimeError("cudaErrorNoDevice: no CUDA-capable device is detected\nmore")


@pytest.mark.parametrize(("cupy", "message"), [
    (None, r"no CuPy .*pip install 'asperity\[gpu\]'"),
    (SimpleNamespace(cuda=SimpleNamespace(runtime=SimpleNamespace(getDeviceCount=no_device))),
     r"no usable CUDA device \(cudaErrorNoDevice: .* detected\); .*nvidia-smi"),
])  # fmt: skip
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


@compiled(_nrt=False)
def preconditioned(room, field, taps, target):
    """Apply the stencil to a field (nx, ny) on a box; the target receives the result."""
    nx, ny = field.shape
    b = empty_box(nx, ny, room)
    masked = b.masked[2 * b.pitch :]
    for i in range(nx):
        for j in range(ny):
            masked[i * b.pitch + j] = field[i, j]
    sums = precondition(b, taps, b.z, None)
    for i in range(nx):
        for j in range(ny):
            target[i, j] = b.z[i * b.pitch + j]
    return sums


@pytest.mark.parametrize(("kind", "accuracy"), [(np.float64, 1e-13), (np.float32, 1e-5)])
def test_the_stencil_of_the_processor_is_that_of_the_device(kind, accuracy):
    """Rows are whole vectors, or not; nothing of a row comes into the next."""
    for ny in (5, 14, 15, 31, 40):
        rng = np.random.default_rng(ny)
        field = (rng.normal(size=(6, ny)) * (rng.random((6, ny)) < 0.8)).astype(kind)
        taps, found = rng.normal(size=6).astype(kind), np.zeros((6, ny), kind)
        room = aligned(box_room(6, ny, 64, 64, width(kind)), kind)
        sums = preconditioned(room, field, taps, found)
        expected = batched.apply_stencil(field[None], tuple(taps.tolist()), np)[0] * (field != 0.0)
        np.testing.assert_allclose(found, expected, rtol=0, atol=accuracy)
        product = (field * expected).sum()
        assert sums == pytest.approx((product, product, expected.sum()), abs=300.0 * accuracy)
