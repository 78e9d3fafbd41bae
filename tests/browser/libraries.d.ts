// The globals that the bundles of src/report/page/vendor are.
import type * as PlotLibrary from "@observablehq/plot";
import type * as ThreeLibrary from "three";
import type { OrbitControls as Orbit } from "three/addons/controls/OrbitControls.js";

declare global {
    const Plot: typeof PlotLibrary;
    const THREE: typeof ThreeLibrary & { OrbitControls: typeof Orbit };
}
