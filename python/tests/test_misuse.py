"""What cannot be is refused by the right exception, with cause and cure."""

import json
import math
import os
import pickle
from pathlib import Path

import numpy as np
import pytest

import phicam

Input, File, SceneError = phicam.InputError, phicam.FileError, phicam.SceneError


def small():
    return phicam.Scene("bench").replace({"laser.spots.per_side": 2, "camera.pixels": (4, 3)})


FLUX = np.full((12, 8), 1e-12)
COUNTS = {"unit": "counts"}
A = np.random.default_rng(1).random((12, 4))


def broken(array, value):
    copy = array.copy()
    copy[3, 2] = value
    return copy


def changed(phi):
    copy = pickle.loads(pickle.dumps(phi))
    copy.flux *= 3.0
    return copy


def unknown(scene):
    return scene.replace({"surface.object.material": {"lambertian": "unknown"}})


def refusing(folder):
    """A folder in which nothing can be made; root can write everywhere but where the system itself says no."""
    if os.geteuid() == 0:
        return Path("/proc/phicam")
    folder.chmod(0o500)
    return folder / "run"


def stopped(phi, folder):
    """A run that was stopped after three spots, as a killed render leaves it."""
    phi.save(folder / "run")
    (folder / "run" / "phi.npy").unlink()
    record = json.loads((folder / "run" / "run.json").read_text())
    del record["digest"], record["files"]
    (folder / "run" / "run.json").write_text(json.dumps(record | {"finished": 3}))
    return folder / "run"


def loaded(phi, folder):
    phi.save(folder / "run")
    return phicam.load(folder / "run")


def saturated(phi):
    with pytest.warns(phicam.Suspicious, match="saturated"):
        return phicam.expose(phi, "machine-vision", exposure=1e3)


MISUSES = [
    # Scenes.
    ("no such scene", SceneError, lambda s, p, t: phicam.Scene("nowhere"), "nowhere"),
    ("a folder for a scene", SceneError, lambda s, p, t: phicam.Scene(t), "cure"),
    ("text that is no TOML", SceneError, lambda s, p, t: phicam.Scene.from_toml("name = "), "1:"),
    ("an unknown key", SceneError, lambda s, p, t: s.replace({"camera.pixel": (4, 4)}), "pixels"),
    ("no pixels", SceneError, lambda s, p, t: s.replace({"camera.pixels": (0, 4)}), "pixel"),
    ("a value of no kind", Input, lambda s, p, t: s.replace({"camera.pixels": object()}), "give a number"),
    ("nan in a scene", SceneError, lambda s, p, t: s.replace({"laser.power": math.nan}), "power"),
    ("an unknown surface", SceneError, lambda s, p, t: s.replace({"surface.door.material": 1}), "wall"),
    ("an unknown parameter", SceneError, lambda s, p, t: s.displaced({"hinge.colour": 1.0}), "cure"),
    ("displaced by nan", Input, lambda s, p, t: s.displaced({"hinge.angle": math.nan}), "finite"),
    ("light of an unknown albedo", SceneError, lambda s, p, t: phicam.render(unknown(s), samples=32), "is unknown"),
    ("its verdict", SceneError, lambda s, p, t: phicam.validate(FLUX, unknown(s), stderr=FLUX), "is unknown"),
    ("its photographs", SceneError, lambda s, p, t: phicam.model(unknown(s)).phi(), "is unknown"),
    ("its integrals", SceneError, lambda s, p, t: phicam.model(unknown(s)).converged(), "is unknown"),
    ("a study of it", SceneError, lambda s, p, t: phicam.study("noise", unknown(s)), "is unknown"),
    ("a picture without pixels", Input, lambda s, p, t: s.preview((0, 10)), "size"),
    # Renders.
    ("no samples", Input, lambda s, p, t: phicam.render(s, samples=0), "samples"),
    ("half a sample", Input, lambda s, p, t: phicam.render(s, samples=1.5), "whole"),
    ("a negative seed", Input, lambda s, p, t: phicam.render(s, seed=-1), "seed"),
    ("no such estimator", Input, lambda s, p, t: phicam.render(s, estimator="fast"), "independent"),
    ("no such sampler", Input, lambda s, p, t: phicam.render(s, sampler="halton"), "sobol"),
    ("a spot beyond the last", Input, lambda s, p, t: phicam.render(s, spots=10**6), "spots is 1000000"),
    ("half a spot", Input, lambda s, p, t: phicam.render(s, spots=[0.5]), "an index, a slice"),
    ("no spots", Input, lambda s, p, t: phicam.render(s, spots=[]), "names none"),
    ("some spots as a run", Input, lambda s, p, t: phicam.render(s, samples=32, spots=0).save(t), "whole render"),
    ("no threads", Input, lambda s, p, t: phicam.render(s, threads=0), "threads"),
    ("a negative number of threads", Input, lambda s, p, t: phicam.render(s, threads=-1), "threads is -1"),
    ("a scene by its name", Input, lambda s, p, t: phicam.render("bench"), "phicam.Scene('bench')"),
    ("a model of a name", Input, lambda s, p, t: phicam.model("bench"), "phicam.Scene('bench')"),
    ("validated against a name", Input, lambda s, p, t: phicam.validate(p, "bench"), "phicam.Scene('bench')"),
    ("a render that was changed", Input, lambda s, p, t: changed(p).save(t), "not what was rendered"),
    ("a side in place of a model's", Input, lambda s, p, t: setattr(phicam.model(s), "laser_side", A), "model_of"),
    ("a side that is changed", ValueError, lambda s, p, t: phicam.model(s).camera_side.fill(1.0), "read-only"),
    ("one photograph by its laser side", Input, lambda s, p, t: phicam.recover(A[:, 0], A, "pinv"), "joint-unbounded"),
    ("a word for a switch", Input, lambda s, p, t: phicam.recover(p, background="no"), "True or False"),
    ("options as keywords", Input, lambda s, p, t: phicam.recover(p, method="joint", elements=(99, 99)), "(elements)"),
    ("no such spot", Input, lambda s, p, t: p.frame(99), "0 to 7"),
    ("more than the memory", Input, lambda s, p, t: phicam.render(s.replace({"camera.pixels": (8000, 8000)})), "GiB"),
    ("a model of more than the memory", Input, lambda s, p, t: phicam.model(s, elements=(9999, 9999)), "cure"),
    # Models.
    ("no such kernel", Input, lambda s, p, t: phicam.model(s, kernel="soft"), "physical"),
    ("no such integration", Input, lambda s, p, t: phicam.model(s, integration="best"), "quadrature"),
    ("elements of no number", Input, lambda s, p, t: phicam.model(s, elements=(0, 2)), "elements"),
    ("reflectances of another number", Input, lambda s, p, t: phicam.model(s).phi([1.0, 2.0]), "64"),
    ("sides that do not fit", Input, lambda s, p, t: phicam.model_of(A, np.ones((5, 1))), "5"),
    ("a grid that does not fit", Input, lambda s, p, t: phicam.model_of(A, None, (3, 3)), "3"),
    # Arrays.
    ("nan in phi", Input, lambda s, p, t: phicam.recover(broken(FLUX, np.nan), s, "joint"), "[3, 2]"),
    ("infinity in stderr", Input, lambda s, p, t: phicam.validate(p, stderr=broken(FLUX, np.inf)), "[3, 2]"),
    ("negative stderr", Input, lambda s, p, t: phicam.validate(p, stderr=-FLUX), "negative"),
    ("another shape", Input, lambda s, p, t: phicam.recover(FLUX[:, :5], s, "joint"), "12 × 8"),
    ("three dimensions", Input, lambda s, p, t: phicam.recover(FLUX.reshape(3, 4, 8), s), "pixels × spots"),
    ("complex numbers", Input, lambda s, p, t: phicam.recover(FLUX * 1j, s), "real"),
    ("words", Input, lambda s, p, t: phicam.recover([["a", "b"]], s), "real"),
    ("rows of several lengths", Input, lambda s, p, t: phicam.recover([[1.0, 2.0], [3.0]], s), "cure"),
    ("a masked array", Input, lambda s, p, t: phicam.recover(np.ma.masked_less(FLUX, 1), s), "left_out"),
    ("nothing in it", Input, lambda s, p, t: phicam.recover(np.zeros((0, 8)), s), "empty"),
    ("no standard errors", Input, lambda s, p, t: phicam.validate(FLUX, s), "stderr"),
    ("no scene", Input, lambda s, p, t: phicam.validate(FLUX, stderr=FLUX), "model="),
    ("a model of other elements", Input, lambda s, p, t: phicam.validate(p, phicam.model(s, elements=(1, 1))), "elements of its own"),
    ("a model of matrices", Input, lambda s, p, t: phicam.validate(p, phicam.model_of(A)), "scene"),
    ("a probability of 2", Input, lambda s, p, t: phicam.validate(p, significance=2), "significance"),
    # Recoveries.
    ("one level", Input, lambda s, p, t: phicam.recover(p, method="joint-two-valued", levels=0.5), "(0.1, 0.8)"),
    ("by a name", Input, lambda s, p, t: phicam.recover(FLUX, "bench", stderr=FLUX), "phicam.Scene('bench')"),
    ("no such method", Input, lambda s, p, t: phicam.recover(p, method="magic"), "joint"),
    ("a method twice", Input, lambda s, p, t: phicam.recover(p, method=["pinv", "pinv"]), "once"),
    ("no method", Input, lambda s, p, t: phicam.recover(p, method=[]), "name"),
    ("a setting of another method", Input, lambda s, p, t: phicam.recover(p, method="pinv", tv=0.1), "joint-tv"),
    ("noise and stderr", Input, lambda s, p, t: phicam.recover(p, noise=0.1, stderr=FLUX), "one of them"),
    ("negative noise", Input, lambda s, p, t: phicam.recover(p, noise=-0.1), "noise"),
    ("neighbours of no grid", Input, lambda s, p, t: phicam.recover(A[:, 0], A, "joint-gp"), "elements"),
    ("nothing to invert by", Input, lambda s, p, t: phicam.recover(FLUX), "model="),
    ("a kernel of matrices", Input, lambda s, p, t: phicam.recover(FLUX, (A, A), kernel="published"), "which have none"),
    ("a kernel of a Model", Input, lambda s, p, t: phicam.recover(p, phicam.model(s), kernel="published"), "made already"),
    ("three matrices", Input, lambda s, p, t: phicam.recover(FLUX, (A, A, A)), "pair"),
    ("darkness", Input, lambda s, p, t: phicam.recover(np.zeros((12, 8)), s, "joint", stderr=FLUX), "no light"),
    # Others.
    ("no such sensor", SceneError, lambda s, p, t: phicam.expose(p, "eye"), "machine-vision"),
    ("no sensor", Input, lambda s, p, t: phicam.expose(p), "sensor"),
    ("exposed twice", Input, lambda s, p, t: phicam.expose(phicam.expose(p, "ideal"), "ideal"), "clean"),
    ("no such study", Input, lambda s, p, t: phicam.study("luck"), "noise"),
    ("no such option", Input, lambda s, p, t: phicam.study("convergence", s, luck=3), "samples"),
    ("an option of another kind", Input, lambda s, p, t: phicam.study("convergence", s, samples="many"), "samples"),
    ("nothing free", Input, lambda s, p, t: phicam.calibrate(p, []), "cure"),
    ("an array for a Phi", Input, lambda s, p, t: phicam.locate(FLUX), "Phi"),
    ("nothing of that name", Input, lambda s, p, t: phicam.locate(p, "colour", (0, 1)), "normal"),
    ("a range turned round", Input, lambda s, p, t: phicam.locate(p, "angle", (1, -1)), "smaller"),
    ("photographs of no scene", Input, lambda s, p, t: phicam.import_photographs({"frames": "*.png"}), "scene"),
    ("photographs that are not there", Input, lambda s, p, t: phicam.import_photographs({"frames": "no-*.png"}, s), ""),
    ("a list that is not there", File, lambda s, p, t: phicam.import_photographs(t / "no.toml", s), "no.toml"),
    ("a pattern of nothing", Input, lambda s, p, t: phicam.recover(p, method="joint", frame_patterns=0 * A), "0 everywhere"),
    ("bands of no method", Input, lambda s, p, t: phicam.recover(p, method="joint-tv", bands=0.9), "bands"),
    ("saturated photographs", Input, lambda s, p, t: phicam.recover(saturated(p), method="joint"), "saturated"),
    # Folders.
    ("no folder", File, lambda s, p, t: phicam.load(t / "nowhere"), "run.json"),
    ("a folder with something in it", File, lambda s, p, t: (t.joinpath("x").touch(), p.save(t)), "empty"),
    ("a file for a folder", File, lambda s, p, t: (t.joinpath("x").touch(), p.save(t / "x")), "x"),
    ("a folder that refuses", File, lambda s, p, t: p.save(refusing(t)), "cannot write"),
    ("a run that was stopped", File, lambda s, p, t: phicam.load(stopped(p, t)), "3 of 8 spots"),
    ("a loaded run as a run", Input, lambda s, p, t: loaded(p, t).save(t / "again"), "copy the folder"),
    ("counts taken for W", Input, lambda s, p, t: phicam.recover(phicam.Phi(s, FLUX, FLUX, account=COUNTS)), "free_scale=True"),
    ("counts by joint", Input, lambda s, p, t: phicam.recover(phicam.Phi(s, FLUX, FLUX, account=COUNTS), method="joint"), "counts"),
    ("counts against a model", Input, lambda s, p, t: phicam.validate(phicam.Phi(s, FLUX, FLUX, account=COUNTS)), "watts"),
    ("photographs as a run", Input, lambda s, p, t: phicam.Phi(s, FLUX, FLUX).save(t), "whole render"),
]


@pytest.fixture(scope="module")
def own():
    scene = small()
    return scene, phicam.render(scene, samples=32)


@pytest.mark.parametrize(("error", "call", "says"), [m[1:] for m in MISUSES], ids=[m[0] for m in MISUSES])
def test_refused(own, tmp_path, error, call, says):
    with pytest.raises(error) as caught:
        call(*own, tmp_path)
    assert says in str(caught.value), str(caught.value)


def test_there_are_forty():
    assert len(MISUSES) >= 40


def test_errors_are_what_python_expects():
    assert issubclass(phicam.InputError, ValueError) and issubclass(phicam.FileError, OSError)
    for kind in (phicam.InputError, phicam.SceneError, phicam.FileError, phicam.InternalError, phicam.Stopped):
        assert issubclass(kind, phicam.Error)
        assert str(pickle.loads(pickle.dumps(kind("a\n  cure: b")))) == "a\n  cure: b"


def test_a_damaged_run_is_refused(own, tmp_path):
    own[1].save(tmp_path / "run")
    path = tmp_path / "run" / "phi.npy"
    data = bytearray(path.read_bytes())
    data[-1] ^= 1
    path.write_bytes(data)
    with pytest.raises(phicam.FileError, match="SHA-256"):
        phicam.load(tmp_path / "run")


def test_inputs_are_not_changed_and_any_layout_is_taken(own):
    scene, phi = own
    flux = phi.flux.copy()
    flux.flags.writeable = False
    plain = phicam.recover(flux, scene, "joint", stderr=phi.stderr, elements=2).reflectance
    wide = np.zeros((24, 16))
    wide[::2, ::2] = flux
    for other in (np.asfortranarray(flux), np.ascontiguousarray(flux), wide[::2, ::2], flux.astype(">f8"), flux.tolist()):
        found = phicam.recover(other, scene, "joint", stderr=phi.stderr, elements=2).reflectance
        assert (found == plain).all()
    single = phicam.recover(flux.astype(np.float32), scene, "joint", stderr=phi.stderr, elements=2).reflectance
    assert np.abs(single - plain).max() < 1e-2
    assert (flux == phi.flux).all()


def test_what_is_left_out_may_be_anything(own):
    """Entries that do not count may be NaN, and change nothing."""
    scene, phi = own
    flags = np.zeros((12, 8))
    flags[3, 2] = 1
    for value in (np.nan, np.inf, 1.0):
        flux, stderr = broken(phi.flux, value), broken(phi.stderr, value)
        found = phicam.recover(flux, scene, "joint", stderr=stderr, left_out=flags, elements=(2, 2))
        verdict = phicam.validate(flux, scene, stderr=stderr, left_out=flags)
        if np.isnan(value):
            first = found.reflectance, verdict.chi2_per_dof
        assert (found.reflectance == first[0]).all() and verdict.chi2_per_dof == first[1]


def test_one_number_is_the_error_of_every_entry(own):
    scene, phi = own
    every = float(phi.stderr.max())
    one, all_of = (phicam.recover(phi, method="joint", elements=(2, 2), stderr=s) for s in (every, np.full((12, 8), every)))
    assert (one.reflectance == all_of.reflectance).all() and one.fit == all_of.fit
    assert phicam.validate(phi, stderr=every).chi2_per_dof == phicam.validate(phi, stderr=np.full((12, 8), every)).chi2_per_dof


def test_a_model_that_does_not_fit_warns(own):
    """Of one element the board is a grey."""
    scene = own[0].replace({"camera.pixels": (8, 8), "laser.spots.per_side": 4})
    phi = phicam.render(scene, samples=1024)
    assert phicam.validate(phi, phicam.model(scene))
    with pytest.warns(phicam.Suspicious, match="by centres"):
        assert phicam.recover(phi, phicam.model(scene, elements=(1, 1)), "joint").fits is False


def test_dark_frames_serve_every_spot():
    """Their error does not average out over the spots: no errors are stated unless a background takes it."""
    scene = phicam.Scene("bench").replace({"surface.object.elements": (2, 2), "camera.pixels": (8, 8)})
    phi = phicam.render(scene, samples=4096)
    with pytest.warns(phicam.Suspicious, match="dark frames"):
        few = phicam.expose(phi, "ccd", exposure=0.02, frames=64, dark_frames=4)
    assert few.errors == "pixel" and pickle.loads(pickle.dumps(few)).errors == "pixel"
    assert phicam.recover(few, method="joint-unbounded").stderr is None
    assert phicam.recover(few, method="joint-unbounded", background=True).stderr is not None
    assert phicam.expose(phi, "ccd", exposure=0.02, dark_frames=0).errors == "independent"


def test_photographs_come_back_from_xarray(own):
    scene, phi = own
    data = phi.to_xarray()
    again = phicam.Phi(scene, data.flux, data.stderr.values, left_out=data.left_out)
    assert (again.flux == phi.flux).all() and (again.stderr == phi.stderr).all() and again.shape == phi.shape == (12, 8)
    assert (phicam.Phi(scene, np.stack([phi.frame(k) for k in range(8)], axis=-1)).flux == phi.flux).all()
