"""phicam by its command line: Φcam by quadrature, Φcam by an estimator and the CPU time that it takes."""

import resource
import shutil
import subprocess

import numpy as np


def cpu():
    """CPU time (s) of the children that have ended."""
    use = resource.getrusage(resource.RUSAGE_CHILDREN)
    return use.ru_utime + use.ru_stime


class Program:
    def __init__(self, binary, folder):
        self.binary, self.folder = binary, folder

    def _call(self, *words):
        subprocess.run([str(self.binary), *map(str, words)], check=True, stdout=subprocess.DEVNULL)

    def converged(self, scene):
        """Φcam by quadrature refined until it stands still."""
        out = self.folder / "converged"
        self._call("model", scene, "--integration", "quadrature", "-q", "-o", out)
        phi = np.load(out / "model" / "phi.npy")
        shutil.rmtree(out)
        return phi

    def exported(self, scene, name):
        """Writes the Mitsuba program of the scene as the module `name`."""
        self._call("scene", "export", scene, "--mitsuba", "-q", "-o", self.folder / f"{name}.py")

    def render(self, scene, estimator, sampler, samples, seed):
        """Φcam and the CPU time (s) of the whole process: start, tracing, all files."""
        out = self.folder / "render"
        begin = cpu()
        self._call(
            "render", scene, "--estimator", estimator, "--sampler", sampler, "--samples", samples, "--seed", seed,
            "--threads", 1, "-q", "-o", out,
        )  # fmt: skip
        spent = cpu() - begin
        phi = np.load(out / "phi.npy")
        shutil.rmtree(out)
        return phi, spent


class Traced:
    """Φcam by one estimator of phicam. The fixed cost of a process (its start, the files of every spot) is that of a run with
    the fewest points that `factored` takes, which is subtracted."""

    def __init__(self, program, scene, estimator, sampler, fixed):
        self.program, self.scene, self.estimator, self.sampler, self.fixed = program, scene, estimator, sampler, fixed

    def run(self, samples, seed):
        phi, spent = self.program.render(self.scene, self.estimator, self.sampler, samples, seed)
        return phi, spent - self.fixed
