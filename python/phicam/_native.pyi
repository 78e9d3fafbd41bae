"""What the crate does, as phicam's own files call it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, final

from numpy.typing import NDArray

from ._arrays import Floats

__version__: str

@final
class Scene:
    @staticmethod
    def load(name: str, also: list[Path]) -> Scene: ...
    @staticmethod
    def parse(text: str) -> Scene: ...
    def with_values(self, changes: list[tuple[str, str]]) -> Scene: ...
    def displaced(self, values: list[tuple[str, float]]) -> Scene: ...
    @property
    def name(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def max_bounces(self) -> int: ...
    @property
    def pixels(self) -> tuple[int, int]: ...
    @property
    def power(self) -> float: ...
    @property
    def wavelength(self) -> float: ...
    @property
    def spots(self) -> Floats: ...
    @property
    def footprints(self) -> Floats: ...
    @property
    def hidden(self) -> list[tuple[str, tuple[int, int], bool]]: ...
    @property
    def uncertainty(self) -> list[tuple[str, float]]: ...
    @property
    def sensor(self) -> str: ...
    def truth(self) -> Floats: ...
    def warnings(self) -> list[str]: ...
    def parameters(self, names: list[str]) -> list[tuple[str, str]]: ...
    def files(self) -> list[tuple[str, bytes]]: ...
    def svg(self) -> str: ...
    def preview(self, size: tuple[int, int], samples: int) -> Floats: ...
    def mitsuba_script(self) -> str: ...

@final
class Model:
    @staticmethod
    def of_scene(
        scene: Scene,
        kernel_name: str,
        elements: tuple[int, int] | None,
        considered: bool,
        integration_name: str,
    ) -> Model: ...
    @staticmethod
    def of_sides(camera_side: NDArray[Any], laser_side: NDArray[Any], elements: tuple[int, int]) -> Model: ...
    @property
    def g12(self) -> Floats: ...
    @property
    def g23(self) -> Floats: ...
    @property
    def camera_side(self) -> Floats: ...
    @property
    def laser_side(self) -> Floats: ...
    @property
    def albedo(self) -> list[float]: ...
    @property
    def places(self) -> Floats: ...
    @property
    def grids(self) -> list[tuple[str, tuple[int, int]]]: ...
    @property
    def shape(self) -> tuple[int, int, int]: ...
    def own_albedo(self) -> list[float]: ...
    def phi(self, albedo: list[float]) -> Floats: ...
    def converged(self) -> tuple[Floats, Floats]: ...
    def derivatives(self, name: str, albedo: list[float]) -> list[tuple[str, Floats]]: ...

def builtins() -> list[tuple[str, str]]: ...
def sensors() -> list[tuple[str, str]]: ...
def shares_by_pixel(common: float, spots: int) -> bool: ...
def relative_errors(phi: Floats, noise: float, left_out: Floats | None) -> Floats: ...
def methods() -> list[str]: ...
def setting_methods(name: str) -> list[str]: ...
def setting_range(name: str) -> str: ...
def setting_allows(name: str, value: float) -> bool: ...
def locatable() -> list[tuple[str, str]]: ...
def scene_named(text: str) -> str: ...
def gallery_svg(
    title: str,
    unit: str,
    is_reflectance: bool,
    pictures: Sequence[tuple[str, tuple[int, int], list[float], tuple[str, str], float]],
) -> str: ...
def aimed(
    scene: Scene, *, sampler: str, seed: int
) -> tuple[Literal["independent", "shared", "factored"], int]: ...
def render(
    scene: Scene,
    *,
    estimator: str,
    sampler: str,
    seed: int,
    samples: int,
    spots: tuple[int, int],
    threads: int | None,
    progress: Any,
) -> dict[str, Any]: ...
def validate(
    scene: Scene,
    phi: NDArray[Any],
    stderr: NDArray[Any],
    *,
    kernel_name: str,
    integration_name: str,
    considered: bool,
    significance: float,
    known: tuple[str, int | None, float],
    paths: int | None,
    beside: Any,
    threads: int | None,
) -> tuple[dict[str, Any], Floats, Floats]: ...
def expose(
    scene: Scene,
    phi: NDArray[Any],
    render_error: NDArray[Any],
    *,
    blocks: int,
    seed: int,
    by_counts: bool,
    threads: int | None,
) -> dict[str, Any]: ...
def recover(
    model: Model,
    phi: NDArray[Any],
    stderr: NDArray[Any] | None,
    *,
    methods: list[str] | None,
    is_grid: bool,
    settings: Any,
    beside: Any,
    known: tuple[str, int | None, float],
    trusted: bool,
    threads: int | None,
) -> tuple[list[dict[str, Any]], list[tuple[str, str]]]: ...
def studies() -> list[tuple[str, str, str | None, list[tuple[str, str, str, str | None, bool]]]]: ...
def study(
    name: str,
    scene: Scene,
    options: list[tuple[str, list[str]]],
    *,
    threads: int | None,
    progress: Any,
) -> tuple[dict[str, Any], bool]: ...
def published() -> list[str]: ...
def reproduce(
    item: str, *, most_elements: int, draws: int, seed: int, threads: int | None, progress: Any
) -> tuple[dict[str, Any], bool]: ...
def targets() -> list[tuple[str, str]]: ...
def target(name: str, size: tuple[int, int] | None) -> tuple[list[float], tuple[int, int]]: ...
def calibrate(
    scene: Scene,
    phi: NDArray[Any],
    stderr: NDArray[Any] | None,
    left_out: NDArray[Any] | None,
    *,
    free: list[tuple[str, float | None]],
    frame_gain: float | None,
    free_scale: bool,
    error_field: bool,
    background: bool,
    known: tuple[str, int | None, float],
    elements: tuple[int, int] | None,
    considered: bool,
    integration_name: str,
    frame_polynomial: int | None,
    starts: int,
    spread: float,
    seed: int,
    threads: int | None,
    progress: Any,
) -> tuple[dict[str, Any], bool, Scene]: ...
def locate(
    scene: Scene,
    phi: NDArray[Any],
    stderr: NDArray[Any] | None,
    left_out: NDArray[Any] | None,
    *,
    known: tuple[str, int | None, float],
    what: str,
    range: tuple[float, float],
    steps: int,
    elements: tuple[int, int] | None,
    considered: bool,
    integration_name: str,
    frame_polynomial: int | None,
    background: bool,
    orders: int,
    seed: int,
    threads: int | None,
    progress: Any,
) -> tuple[dict[str, Any], bool]: ...
def import_photographs(
    scene: Scene, text: str, folder: Path, channel: str | None, *, threads: int | None
) -> tuple[dict[str, Any], Scene]: ...
def write_run(
    folder: Path,
    scene: Scene,
    flux: NDArray[Any],
    stderr: NDArray[Any],
    tails: NDArray[Any],
    bounces: list[NDArray[Any]],
    *,
    estimator: str,
    sampler: str,
    seed: int,
    samples: int,
    seconds: float,
    threads: int,
) -> None: ...
def read_run(folder: Path, also: list[Path]) -> tuple[Scene, dict[str, Any]]: ...
