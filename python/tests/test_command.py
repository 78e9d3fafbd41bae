"""The same bytes as the command's files."""

import json
import subprocess
import time

import numpy as np
import pytest

import phicam


@pytest.fixture(scope="module")
def run(command, scene, tmp_path_factory):
    """A run that the command rendered."""
    folder = tmp_path_factory.mktemp("command")
    (folder / "scene.toml").write_text(scene.text)
    command("render", folder / "scene.toml", "-o", folder / "run", "--samples", 64)
    return folder / "run"


def same(array, path):
    """Whether the array is that of the file, to the bit."""
    there = np.load(path)
    return array.shape == there.shape and np.ascontiguousarray(array).tobytes() == np.ascontiguousarray(there).tobytes()


def test_render(run, phi):
    assert same(phi.flux, run / "phi.npy")
    assert same(phi.stderr, run / "phi.stderr.npy")
    assert same(phi.left_out, run / "phi.tails.npy")


@pytest.mark.parametrize("estimator", ["shared", "factored"])
def test_estimators(command, run, scene, tmp_path, estimator):
    source = run.parent / "scene.toml"
    command("render", source, "-o", tmp_path, "--samples", 32, "--estimator", estimator, "--sampler", "pcg", "--seed", 7)
    phi = phicam.render(scene, samples=32, estimator=estimator, sampler="pcg", seed=7, threads=1)
    assert same(phi.flux, tmp_path / "phi.npy")


@pytest.mark.parametrize("estimator", ["independent", "shared", "factored"])
@pytest.mark.parametrize("spots", [3, slice(2, None, 3), [5, 0, 1, -1], range(4)])
def test_some_spots(scene, estimator, spots):
    whole = phicam.render(scene, samples=32, estimator=estimator)
    some = phicam.render(scene, samples=32, estimator=estimator, spots=spots)
    count = scene.shape[1]
    chosen = np.zeros(count, dtype=bool)
    chosen[spots if not isinstance(spots, range) else list(spots)] = True
    for name in ("flux", "stderr", "left_out"):
        assert (getattr(some, name)[:, chosen] == getattr(whole, name)[:, chosen]).all(), name
    assert (some.flux[:, ~chosen] == 0).all() and (some.left_out[:, ~chosen] == 1).all()
    assert all((a[:, chosen] == b[:, chosen]).all() for a, b in zip(some.by_bounces, whole.by_bounces, strict=True))
    assert some.settings["spots"] == np.flatnonzero(chosen).tolist()


def test_some_spots_are_recovered(scene):
    some = phicam.render(scene, samples=256, spots=slice(0, None, 2))
    found = phicam.recover(some, method="joint", elements=(2, 2))
    halved = np.zeros(scene.shape)
    halved[:, 1::2] = 1
    whole = phicam.render(scene, samples=256)
    assert (found.reflectance == phicam.recover(whole, method="joint", elements=(2, 2), left_out=halved).reflectance).all()
    assert phicam.validate(some).agrees


def test_some_spots_tell_of_all(scene):
    told = []
    phicam.render(scene, samples=32, spots=[0, 2, 3], progress=lambda done, of: told.append((done, of)))
    assert told[-1] == (told[-1][1], 3 * 32 * scene.shape[0]) and told == sorted(told)


def test_model(command, run, scene, tmp_path):
    command("model", run.parent / "scene.toml", "-o", tmp_path)
    model = phicam.model(scene)
    folder = tmp_path / "model"
    assert same(model.g12, folder / "g12.npy")
    assert same(model.g23, folder / "g23.npy")
    assert same(model.camera_side, folder / "camera_side.npy")
    assert same(model.laser_side, folder / "laser_side.npy")
    assert same(model.phi(), folder / "phi.npy")


def test_model_by_quadrature(command, run, scene, tmp_path):
    command("model", run.parent / "scene.toml", "-o", tmp_path, "--integration", "quadrature")
    assert same(phicam.model(scene).converged()[0], tmp_path / "model" / "phi.npy")


def test_validate(command, run, phi):
    said = json.loads(command("validate", run, "--json"))
    verdict = phicam.validate(phi)
    assert verdict.values == said


def test_validate_counts(command, run, phi):
    said = json.loads(command("validate", run, "--json", "--free-scale", "--frame-polynomial", 0))
    assert phicam.validate(phi, free_scale=True, frame_polynomial=0).values == said
    counts = phicam.Phi(phi.scene, 2e15 * phi.flux + 7.0, 2e15 * phi.stderr, account={"unit": "counts"})
    verdict = phicam.validate(counts, free_scale=True, frame_polynomial=0)
    assert verdict.agrees and abs(verdict.values["best_scale"] / 2e15 - 1) < 0.1
    said = json.loads(command("validate", run, "--json", "--background", "--frame-gain", 0.02))
    verdict = phicam.validate(phi, background=True, frame_gain=0.02)
    assert verdict.values == said and len(said["gains"]["frames"]["size"]) == phi.flux.shape[1]


def test_recover(command, run, phi):
    methods = ["pinv", "tsvd", "joint", "joint-gp"]
    command("recover", run, *(word for method in methods for word in ("--method", method)))
    found = phicam.recover(phi, method=methods)
    for each in (found, *found.others):
        nu, nv = each.surfaces[0].elements
        assert same(each.picture(), run / "recovered" / f"{each.method}.npy"), each.method
        if each.stderr is not None:
            assert same(each.stderr.reshape(nv, nu), run / "recovered" / f"{each.method}.stderr.npy"), each.method
        if each.covariance is not None:
            assert same(each.covariance, run / "recovered" / f"{each.method}.covariance.npy"), each.method


def test_recover_of_matrices(command, phi, tmp_path):
    model = phicam.model(phi.scene, elements=(4, 4))
    for name, array in (("c", model.camera_side), ("d", model.laser_side), ("phi", phi.flux)):
        np.save(tmp_path / f"{name}.npy", array)
    files = [tmp_path / f"{name}.npy" for name in ("phi", "c", "d")]
    command(
        "recover", "--phi", files[0], "--camera-side", files[1], "--laser-side", files[2], "--noise", 0.1,
        "--method", "joint", "-o", tmp_path / "out",
    )  # fmt: skip
    found = phicam.recover(phi.flux, (model.camera_side, model.laser_side), "joint", noise=0.1)
    assert same(found.picture(), tmp_path / "out" / "joint.npy")


def test_expose(command, run, phi, tmp_path):
    command("expose", run, "--sensor", "machine-vision", "--exposure", 0.005, "-o", tmp_path, "--seed", 3)
    exposed = phicam.expose(phi, "machine-vision", exposure=0.005, seed=3)
    assert same(exposed.flux, tmp_path / "phi.npy")
    assert same(exposed.stderr, tmp_path / "phi.stderr.npy")
    assert same(exposed.clipped, tmp_path / "saturated.npy")


def test_a_saved_run_is_the_commands(command, run, phi, tmp_path):
    folder = tmp_path / "saved"
    phi.save(folder)
    assert (folder / "phi.npy").read_bytes() == (run / "phi.npy").read_bytes()
    frames = sorted(path.name for path in (run / "frames").iterdir())
    assert frames == sorted(path.name for path in (folder / "frames").iterdir())
    for name in frames:
        assert (folder / "frames" / name).read_bytes() == (run / "frames" / name).read_bytes()
    said = json.loads(command("validate", folder, "--json"))
    assert said == json.loads(command("validate", run, "--json"))
    # The same render into it has nothing left to do.
    command("render", run.parent / "scene.toml", "-o", folder, "--samples", 64)
    command("stack", folder)


def test_a_commands_run_is_loaded(run, phi):
    loaded = phicam.load(run)
    assert loaded.scene == phi.scene
    assert loaded.settings | {"seconds": 0, "threads": 0} == phi.settings | {"seconds": 0, "threads": 0}
    assert (loaded.flux == phi.flux).all() and (loaded.stderr == phi.stderr).all()
    assert [b.tobytes() for b in loaded.by_bounces] == [b.astype("f4").tobytes() for b in phi.by_bounces]
    assert loaded.by_bounces[2].any()


def test_a_run_that_was_stopped_is_no_run(command, scene, tmp_path):
    (tmp_path / "scene.toml").write_text(scene.text)
    run = [command.program, "-q", "render", tmp_path / "scene.toml", "-o", tmp_path / "run", "--samples", "1000000"]
    with subprocess.Popen([str(word) for word in run], stderr=subprocess.DEVNULL) as process:
        while not all((tmp_path / "run" / name).exists() for name in ("run.json", "scene.toml")):
            assert process.poll() is None
            time.sleep(0.01)
        process.kill()
    with pytest.raises(phicam.FileError, match="of 16 spots\n  cure: finish it"):
        phicam.load(tmp_path / "run")


def test_noise_of_repeats(command, scene, tmp_path):
    """What a few repeats leave unknown of the noise is part of the verdict, as of the command; Fisher's law of 2 × 24 pairs."""
    columns, rows = scene.pixels
    light = phicam.model(scene).phi()
    counts = np.random.default_rng(3).poisson(light / light.mean() * 400, (2, *light.shape)) + 0.0
    for spot in range(scene.shape[1]):
        for shot in range(2):
            frame = counts[shot, :, spot].reshape(rows, columns)[::-1]
            np.save(tmp_path / f"frame-{2 * spot + shot:03}.npy", frame.astype(np.uint16))
    (tmp_path / "scene.toml").write_text(scene.text)
    (tmp_path / "list.toml").write_text('frames = "frame-*.npy"\nrepeats = 2\nscene = "scene.toml"\n')
    command("import", tmp_path / "list.toml", "-o", tmp_path / "taken")
    found = json.loads(command("validate", tmp_path / "taken", "--free-scale", "--json"))
    taken = phicam.import_photographs(tmp_path / "list.toml")
    for phi in (taken, phicam.load(tmp_path / "taken")):
        assert phi.noise_unknown > 0.0
        assert phicam.validate(phi, free_scale=True).values == found
    known = phicam.Phi(taken.scene, taken.flux, taken.stderr)
    assert phicam.validate(known, free_scale=True).values["chi2_p"] != found["chi2_p"]


def test_study(command, run, scene, tmp_path):
    arguments = ["--samples", "64,256"]
    command("study", "convergence", run.parent / "scene.toml", "-o", tmp_path, *arguments)
    found = phicam.study("convergence", scene, samples=[64, 256])
    written = json.loads((tmp_path / "convergence.json").read_text())
    assert found.values == written
    assert found.files["convergence.svg"] == (tmp_path / "convergence.svg").read_text()


def test_locate(command, run, phi, tmp_path):
    command("locate", run, "--what", "angle", "--range=-5,5", "--steps", 7, "--elements", "2x2", "--orders", 0,
            "-o", tmp_path, code=0)  # fmt: skip
    found = phicam.locate(phi, "angle", (-5, 5), steps=7, elements=(2, 2), orders=0)
    assert found.values == json.loads((tmp_path / "locate.json").read_text())


def test_calibrate(command, run, phi, tmp_path):
    command("calibrate", run, "--free", "hinge.angle", "--elements", "2x2", "--starts", 1, "-o", tmp_path)
    found = phicam.calibrate(phi, ["hinge.angle"], elements=(2, 2), starts=1)
    assert found.values == json.loads((tmp_path / "calibration.json").read_text())
    assert found.scene == phicam.Scene(tmp_path / "scene.toml")
