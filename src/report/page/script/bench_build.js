// The bench as objects of three.js, each part in the group that its tick box shows and hides.

/**
 * @typedef {[number, number, number]} Point
 * @typedef {{ count: [number, number], grey: string, repeat: boolean, reduced: boolean }} GreyBlock
 * @typedef {{ kind: "patch", corner: Point, u: Point, v: Point, normal: Point }} PatchBlock
 * @typedef {{ kind: "disc", centre: Point, u: Point, v: Point, normal: Point }} DiscBlock
 * @typedef {{ kind: "sphere", centre: Point, radius: number, inside: boolean }} SphereBlock
 * @typedef {{ kind: "mesh", mesh: number, motion: number[], inner: boolean }} PlacedMesh
 * @typedef {{ name: string, role: "relay" | "hidden" | "occluder", texture: GreyBlock }} Named
 * @typedef {Named & (PatchBlock | DiscBlock | SphereBlock | PlacedMesh)} SurfaceBlock
 * @typedef {{ vertices: number, triangles: number, whole: number, centre: Point, scale: number, textured: boolean }} MeshBlock
 * @typedef {{ position: Point, corner: Point, u: Point, v: Point, columns: number, rows: number }} CameraBlock
 * @typedef {{ points: Point[], spots: string, pixels: string | null }} WaysBlock
 * @typedef {{ name: string, unit: string, up: Point, near: [Point, Point], surfaces: SurfaceBlock[], meshes: MeshBlock[], spots: { count: number, step: number },
 *     laser: Point | null, camera: CameraBlock, ways: WaysBlock }} BenchBlock
 * @typedef {"walls" | "object" | "obstacles" | "spots" | "beams" | "camera"} Part
 * @typedef {"walls" | "object" | "obstacles" | "spots" | "camera" | "soft" | "ground"} Ink
 * @typedef {{ block: BenchBlock, place: (p: Point) => Three.Vector3, size: number, inks: Record<Ink, string>, geometries: Three.BufferGeometry[], root: Three.Scene,
 *     parts: Record<Part, Three.Group>, spots: ArrayLike<number>, ways: { spots: Uint8Array, pixels: Uint8Array | undefined } }} Bench
 */

/** The inks are properties of the page's style, which are others on dark ground. */
const INKS = { walls: "--ink", object: "--bench-object", obstacles: "--bench-obstacles", spots: "--bench-spots", camera: "--bench-camera", soft: "--soft", ground: "--card" };

/**
 * The inks as they are now.
 * @returns {Record<Ink, string>}
 */
function inksOf() {
    const style = getComputedStyle(document.documentElement);
    return /** @type {Record<Ink, string>} */ (Object.fromEntries(Object.entries(INKS).map(([ink, name]) => [ink, style.getPropertyValue(name).trim()])));
}

/**
 * Colours a material, or paints its mark, with an ink.
 * @template {Three.Material} M
 * @param {Bench} bench
 * @param {M} material
 * @param {{ ink: Ink, pale?: number, mark?: { rim: Ink, shape: MarkShape } }} dress `pale`: the share of the ground in the colour
 * @returns {M}
 */
function inked({ inks }, material, dress) {
    const { ink, pale = 0, mark } = dress;
    const any = /** @type {any} */ (material);
    material.userData.dress = dress;
    if (mark === undefined) {
        any.color.set(inks[ink]).lerp(new THREE.Color(inks.ground), pale);
    } else {
        any.map?.dispose();
        any.map = markTexture(inks[ink], inks[mark.rim], mark.shape);
    }
    return material;
}

/**
 * Takes the inks of the page as they are now.
 * @param {Bench} bench
 */
function inkAgain(bench) {
    bench.inks = inksOf();
    bench.root.traverse((object) => {
        const { material } = /** @type {any} */ (object);
        if (material?.userData.dress !== undefined) {
            inked(bench, material, material.userData.dress);
        }
    });
}

/**
 * Everything that does not depend on what is chosen. Inside, the framed box is at most 1 long and lies around the origin: single precision is enough for benches
 * of every size, anywhere.
 * @param {BenchBlock} block
 * @param {{ vertices: ArrayLike<number>, triangles: ArrayLike<number>, coordinates: ArrayLike<number>, spots: ArrayLike<number> }} packed
 * @returns {Bench}
 */
function buildBench(block, packed) {
    const [low, high] = block.near;
    const centre = low.map((x, i) => 0.5 * x + 0.5 * high[i]);
    const size = Math.max(...high.map((x, i) => x - low[i])) || 1;
    /** @type {(p: Point) => Three.Vector3} */
    const place = ([x, y, z]) => new THREE.Vector3((x - centre[0]) / size, (y - centre[1]) / size, (z - centre[2]) / size);
    const root = new THREE.Scene();
    const group = () => root.add(new THREE.Group()).children[root.children.length - 1];
    const parts = /** @type {Record<Part, Three.Group>} */ ({});
    for (const part of /** @type {Part[]} */ (["walls", "object", "obstacles", "camera", "beams", "spots"])) {
        parts[part] = /** @type {Three.Group} */ (group());
    }
    const bytes = (/** @type {string} */ text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const ways = { spots: bytes(block.ways.spots), pixels: block.ways.pixels === null ? undefined : bytes(block.ways.pixels) };
    const geometries = meshGeometries(block.meshes, packed);
    /** @type {Bench} */
    const bench = { block, place, size, inks: inksOf(), geometries, root, parts, spots: packed.spots, ways };
    for (const surface of block.surfaces) {
        addSurface(bench, surface);
    }
    addPlumbLines(bench);
    addSpots(bench);
    addCamera(bench);
    return bench;
}

/** A mesh of more triangles than this is taken for a curved one: its corners are shared, and shaded smoothly. */
const HEAVY = 500;

/**
 * The geometry of every mesh in the mesh's own space; where corners have texture coordinates, or are few, each triangle has its own.
 * @param {MeshBlock[]} blocks
 * @param {{ vertices: ArrayLike<number>, triangles: ArrayLike<number>, coordinates: ArrayLike<number> }} packed
 */
function meshGeometries(blocks, packed) {
    let [vertex, triangle, coordinate] = [0, 0, 0];
    return blocks.map((block) => {
        const part = (/** @type {ArrayLike<number>} */ from, /** @type {number} */ start, /** @type {number} */ length) => Array.from({ length }, (_, i) => from[start + i]);
        const shared = new THREE.BufferGeometry();
        shared.setAttribute("position", new THREE.Float32BufferAttribute(part(packed.vertices, 3 * vertex, 3 * block.vertices), 3));
        shared.setIndex(part(packed.triangles, 3 * triangle, 3 * block.triangles));
        const geometry = block.textured || block.triangles <= HEAVY ? shared.toNonIndexed() : shared;
        if (block.textured) {
            geometry.setAttribute("uv", new THREE.Float32BufferAttribute(part(packed.coordinates, coordinate, 6 * block.triangles), 2));
            coordinate += 6 * block.triangles;
        }
        geometry.computeVertexNormals();
        vertex += block.vertices;
        triangle += block.triangles;
        return geometry;
    });
}

/**
 * @param {Bench} bench
 * @param {SurfaceBlock} surface
 */
function addSurface(bench, surface) {
    const part = partOf(surface.role);
    const { geometry, matrix, front, outline } = shapeOf(bench, surface);
    const curved = surface.kind === "sphere" || surface.kind === "mesh";
    const other = front === THREE.FrontSide ? THREE.BackSide : THREE.FrontSide;
    for (const material of materialsOf(bench, surface, curved, front, other)) {
        const mesh = new THREE.Mesh(geometry, material);
        mesh.matrixAutoUpdate = false;
        mesh.matrix.copy(matrix);
        bench.parts[part].add(mesh);
    }
    if (outline.length > 0) {
        bench.parts[part].add(lineSegments(bench, outline, part, 2));
    }
    if (surface.kind === "patch" || surface.kind === "disc") {
        bench.parts[part].add(lineSegments(bench, frontTicks(bench, surface), part, 1.5));
    }
}

/**
 * @param {Named["role"]} role
 * @returns {"walls" | "object" | "obstacles"}
 */
function partOf(role) {
    return role === "relay" ? "walls" : role === "hidden" ? "object" : "obstacles";
}

/**
 * How a surface looks. Walls let through what is behind them; the hidden front shows its albedo, its back the same through a
 * tint (of curved ones the tint alone); obstacles are translucent unless they are
 * made of many triangles. Shading is for the eye only.
 * @param {Bench} bench
 * @param {SurfaceBlock} surface
 * @param {boolean} curved
 * @param {0 | 1} front
 * @param {0 | 1} other
 * @returns {Three.Material[]}
 */
function materialsOf(bench, surface, curved, front, other) {
    const part = partOf(surface.role);
    if (surface.role === "hidden") {
        const map = textureOf(surface.texture);
        if (curved) {
            return [twoFaced(bench, new THREE.MeshLambertMaterial({ map, side: THREE.DoubleSide }), front)];
        }
        const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
        const tint = new THREE.MeshBasicMaterial({ side: other, transparent: true, opacity: 0.6, depthWrite: false });
        return [new THREE.MeshBasicMaterial({ map, side: THREE.DoubleSide, ...behind }), inked(bench, tint, { ink: part, pale: 0.35 })];
    }
    const heavy = surface.kind === "mesh" && bench.block.meshes[surface.mesh].triangles > HEAVY;
    const opacity = surface.role === "relay" ? 0.2 : heavy ? 1 : curved ? 0.45 : 0.16;
    const side = surface.kind === "mesh" && !heavy ? front : THREE.DoubleSide;
    const settings = { side, opacity, transparent: opacity < 1, depthWrite: opacity === 1 };
    if (surface.texture.count[0] * surface.texture.count[1] > 1) {
        return [new THREE.MeshBasicMaterial({ ...settings, map: textureOf(surface.texture), opacity: Math.max(opacity, 0.7) })];
    }
    const material = curved ? new THREE.MeshLambertMaterial(settings) : new THREE.MeshBasicMaterial(settings);
    return [inked(bench, material, { ink: part })];
}

/**
 * Shows the back of triangles in the ink of hidden surfaces, in the same pass as their front: large meshes are drawn once.
 * @param {Bench} bench
 * @param {Three.MeshLambertMaterial} material
 * @param {0 | 1} front
 */
function twoFaced(bench, material, front) {
    material.onBeforeCompile = (shader) => {
        shader.uniforms.back = { value: new THREE.Color(bench.inks.object) };
        const back = front === THREE.FrontSide ? "!gl_FrontFacing" : "gl_FrontFacing";
        shader.fragmentShader = `uniform vec3 back;\n${shader.fragmentShader}`.replace("#include <map_fragment>", `#include <map_fragment>\nif (${back}) diffuseColor.rgb = back;`);
    };
    material.customProgramCacheKey = () => `two-faced ${front}`;
    return material;
}

/**
 * Albedo as grey: 0 black, 1 white, each value a sharp cell.
 * @param {GreyBlock} block
 */
function textureOf({ count, grey, repeat }) {
    const text = atob(grey);
    const colours = new Uint8Array(4 * text.length);
    for (let i = 0; i < text.length; i++) {
        colours.fill(text.charCodeAt(i), 4 * i, 4 * i + 3);
        colours[4 * i + 3] = 255;
    }
    const texture = new THREE.DataTexture(colours, count[0], count[1]);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.magFilter = THREE.NearestFilter;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.generateMipmaps = true;
    if (repeat) {
        texture.wrapS = THREE.RepeatWrapping;
        texture.wrapT = THREE.RepeatWrapping;
    }
    texture.needsUpdate = true;
    return texture;
}

/**
 * Short strokes on the front, as the static drawing has them.
 * @param {Bench} bench
 * @param {PatchBlock | DiscBlock} surface
 */
function frontTicks(bench, surface) {
    /** @type {(a: number, b: number) => Point} */
    const at = (a, b) =>
        surface.kind === "patch"
            ? along(along(surface.corner, surface.u, a), surface.v, b)
            : along(along(surface.centre, surface.u, 2 * a - 1), surface.v, 2 * b - 1);
    const halves = surface.kind === "patch" ? [[1, 3], [5, 3], [3, 1], [3, 5], [3, 3]] : [[3, 3]];
    return halves.flatMap(([a, b]) => {
        const foot = at(a / 6, b / 6);
        return [0.002, 0.03].map((t) => bench.place(along(foot, surface.normal, t * bench.size)));
    });
}

/**
 * p + t·d.
 * @param {Point} p
 * @param {Point} d
 * @param {number} t
 * @returns {Point}
 */
function along(p, d, t) {
    return [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]];
}

/**
 * Lines between pairs of points, `width` CSS pixels wide.
 * @param {Bench} bench
 * @param {Three.Vector3[]} points
 * @param {Ink} ink
 * @param {number} width
 * @param {{ opacity?: number, always?: boolean }} [more] `always`: whatever stands before them
 */
function lineSegments(bench, points, ink, width, { opacity = 1, always = false } = {}) {
    const geometry = new THREE.LineSegmentsGeometry();
    geometry.setPositions(points.flatMap((p) => p.toArray()));
    const transparent = opacity < 1 || always;
    const material = new THREE.LineMaterial({ linewidth: width, opacity, transparent, depthTest: !always, depthWrite: !transparent });
    const lines = new THREE.LineSegments2(geometry, inked(bench, material, { ink }));
    lines.renderOrder = always ? 2 : 0;
    return lines;
}
