// The globals that the bundles of src/report/page/vendor are.
import type * as PlotLibrary from "@observablehq/plot";
import type * as ThreeLibrary from "three";
import type { OrbitControls as Orbit } from "three/addons/controls/OrbitControls.js";
import type { LineMaterial } from "three/addons/lines/LineMaterial.js";
import type { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import type { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

declare global {
    const Plot: typeof PlotLibrary;
    const THREE: typeof ThreeLibrary & {
        OrbitControls: typeof Orbit;
        LineMaterial: typeof LineMaterial;
        LineSegments2: typeof LineSegments2;
        LineSegmentsGeometry: typeof LineSegmentsGeometry;
    };
    /** Types of three.js, for comments: a script without imports cannot name them otherwise. */
    namespace Three {
        type BufferGeometry = ThreeLibrary.BufferGeometry;
        type Group = ThreeLibrary.Group;
        type Material = ThreeLibrary.Material;
        type MeshLambertMaterial = ThreeLibrary.MeshLambertMaterial;
        type Matrix4 = ThreeLibrary.Matrix4;
        type Object3D = ThreeLibrary.Object3D;
        type OrbitControls = Orbit;
        type OrthographicCamera = ThreeLibrary.OrthographicCamera;
        type Points = ThreeLibrary.Points;
        type Scene = ThreeLibrary.Scene;
        type Texture = ThreeLibrary.Texture;
        type Vector3 = ThreeLibrary.Vector3;
        type WebGLRenderer = ThreeLibrary.WebGLRenderer;
    }
}
