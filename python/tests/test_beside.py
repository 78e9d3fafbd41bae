"""Other threads, other processes, signals, pickles, memory."""

import multiprocessing
import os
import pickle
import signal
import struct
import subprocess
import sys
import threading
import time
import tracemalloc
import zlib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import phicam


def flux_of(seed):
    scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 3)})
    return phicam.render(scene, samples=32, seed=seed).flux


def test_several_threads():
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(flux_of, [1, 2, 3, 4] * 4))
    for k, flux in enumerate(found):
        assert (flux == found[k % 4]).all()


@pytest.mark.parametrize("how", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_several_processes(how):
    if how not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {how} here")
    here = flux_of(1)
    with multiprocessing.get_context(how).Pool(2) as pool:
        found = pool.map_async(flux_of, [1, 1, 2]).get(timeout=120)
    assert (found[0] == here).all() and (found[1] == here).all() and not (found[2] == here).all()


def test_pickles(scene, phi):
    verdict = phicam.validate(phi)
    found = phicam.recover(phi, method="joint", elements=(2, 2))
    model = phicam.model(scene, elements=(2, 2))
    again = pickle.loads(pickle.dumps([scene, phi, verdict, found, model, phicam.model_of(np.eye(3))]))
    assert again[0] == scene and again[1].scene == scene
    assert (again[1].flux == phi.flux).all()
    assert again[2].values == verdict.values and (again[3].reflectance == found.reflectance).all()
    assert (again[4].camera_side == model.camera_side).all() and again[5].shape == (3, 3, 1)


def png(grey):
    """An 8-bit picture without filters."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows, columns = grey.shape
    lines = b"".join(b"\0" + row.tobytes() for row in grey)
    head = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def test_a_scene_with_files_is_pickled(tmp_path):
    grey = np.arange(64, dtype=np.uint8).reshape(8, 8) * 4
    (tmp_path / "card.png").write_bytes(png(grey))
    (tmp_path / "scene.toml").write_text(phicam.Scene("bench").text)
    scene = phicam.Scene(tmp_path / "scene.toml").replace(
        {"surface.object.material.lambertian": {"image": "card.png", "transfer": "linear"}}
    )
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene and (again.truth == scene.truth).all()


def test_the_interpreter_is_not_held():
    scene = phicam.Scene("bench")
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.perf_counter()
    phicam.render(scene, samples=256, estimator="independent", threads=1)
    took = time.perf_counter() - begun
    stop.set()
    thread.join()
    # With the lock held it would count once or twice.
    assert counted[0] > 10 * took


PROGRAM = """
import signal, sys, time, phicam
# A shell that starts this in the background has it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = phicam.Scene("bench").replace({"camera.pixels": (64, 64)})
print("ready", flush=True)
try:
    LONG
except KeyboardInterrupt:
    print("interrupted", flush=True)
    # What is left of it does not keep the program.
    sys.exit(7)
"""

LONG = {
    "render": "phicam.render(scene, samples=1 << 20)",
    "study": "phicam.study('noise', scene)",
    "recover": "phicam.recover(phicam.render(scene, samples=32, estimator='factored'), method='joint-tv', elements=(32, 32))",
}


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("what", LONG)
def test_ctrl_c_ends_it(what):
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM.replace("LONG", LONG[what])], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    time.sleep(3.0)
    assert process.poll() is None, "it ended before it was interrupted"
    begun = time.perf_counter()
    process.send_signal(signal.SIGINT)
    said = process.stdout.readline()
    took = time.perf_counter() - begun
    print(f"{what} ended after {took:.2f} s")
    # Under a second on a quiet machine; hours if nothing looked at the signal.
    assert said == "interrupted\n" and took < 5.0, (said, took)
    assert process.wait(timeout=10) == 7


def test_progress_is_told_and_may_stop_it(scene):
    seen = []
    phicam.render(scene, samples=256, progress=lambda done, of: seen.append((done, of)))
    assert seen[-1][0] == seen[-1][1] and all(done <= of for done, of in seen)

    class Enough(Exception):
        pass

    def enough(done, of):
        raise Enough

    with pytest.raises(Enough):
        phicam.render(phicam.Scene("bench"), samples=4096, progress=enough)


def test_a_thousand_calls_leak_nothing():
    resource = pytest.importorskip("resource")
    scene = phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (2, 2)})
    model = phicam.model(scene, elements=(2, 2))

    def calls(count):
        for _ in range(count):
            phi = phicam.render(scene, samples=32, threads=1)
            phicam.recover(phi, model, "pinv", threads=1)
            try:
                phicam.recover(phi.flux, model, "pinv", stderr=-phi.flux - 1)
            except phicam.InputError:
                pass

    calls(200)
    tracemalloc.start()
    before, peak = tracemalloc.get_traced_memory()[0], resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    calls(1000)
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    # ru_maxrss is in KiB on Linux: a leak of one small matrix a call would be seen.
    assert grown < 200_000, grown
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak < 16_384


def test_what_a_notebook_shows(phi):
    verdict, found = phicam.validate(phi), phicam.recover(phi, method="joint", elements=(2, 2))
    for shown in (phi.scene, phi, verdict, found):
        assert "<svg" in shown._repr_html_() or "<table" in shown._repr_html_()
    assert repr(phi).startswith("Phi(48 pixels × 16 spots of 'bench'")
    assert "agrees" in repr(verdict) and "joint" in repr(found)


def test_a_picture_that_does_not_fit_says_so():
    """Three spots have three directions for the published inversion, of nine."""
    random = np.random.default_rng(3)
    matrix, laser = random.random((60, 9)), random.random((9, 3))
    photos = matrix @ np.diag(np.linspace(0.1, 0.9, 9)) @ laser
    with pytest.warns(phicam.Suspicious, match="DOES NOT FIT"):
        published = phicam.recover(photos, (matrix, laser), "pinv", stderr=0.02)
    assert published.fits is False and "DOES NOT FIT" in repr(published) and not published.is_refuted
    assert any("3 directions of 9" in text for text in published.warnings)
    photo, error = matrix @ np.linspace(0.1, 0.9, 9), np.full(60, 0.02)
    right = phicam.recover(photo, matrix, "joint-unbounded", stderr=error)
    assert right.fits is True and "FIT" not in repr(right)
    assert right.determined.shape == (9,) and right.light is None
    assert phicam.recover(photo, matrix, "joint").fits is None
