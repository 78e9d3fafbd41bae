// Shapes of the bench, and its spots, beams and camera.

/** Devices farther than this many sizes of the bench are drawn no farther, in their direction. */
const FARTHEST = 8;

/**
 * The geometry of a surface: where it goes, which side of its triangles is the front, and its outline as pairs of points.
 * @param {Bench} bench
 * @param {SurfaceBlock} surface
 * @returns {{ geometry: Three.BufferGeometry, matrix: Three.Matrix4, front: 0 | 1, outline: Three.Vector3[] }}
 */
function shapeOf(bench, surface) {
    const { place, size, block } = bench;
    const identity = new THREE.Matrix4();
    if (surface.kind === "patch") {
        const { corner, u, v, normal } = surface;
        const far = along(corner, u, 1);
        const rim = [corner, far, along(far, v, 1), along(corner, v, 1)].map(place);
        const geometry = gridGeometry([[0, 0], [1, 0], [1, 1], [0, 1]], rim, [0, 1, 2, 0, 2, 3]);
        return { geometry, matrix: identity, front: facing(u, v, normal), outline: sidesOf(rim) };
    }
    if (surface.kind === "disc") {
        const { centre, u, v, normal } = surface;
        const at = (/** @type {number[]} */ [a, b]) => place(along(along(centre, u, a), v, b));
        const { uv, indices } = squareGrid(24, 24);
        const rim = Array.from({ length: 96 }, (_, k) => at([Math.cos((Math.PI * k) / 48), Math.sin((Math.PI * k) / 48)]));
        return { geometry: gridGeometry(uv, uv.map(toDisc).map(at), indices), matrix: identity, front: facing(u, v, normal), outline: sidesOf(rim) };
    }
    if (surface.kind === "sphere") {
        // Rows by the angle from +z, so that the poles are round; u of a row is (1 − cos)/2.
        const { uv, indices } = squareGrid(32, 48);
        const points = uv.map(([s, t]) => {
            const [theta, phi] = [Math.PI * s, 2 * Math.PI * t];
            const [sin, cos] = [Math.sin(theta), Math.cos(theta)];
            return new THREE.Vector3(sin * Math.cos(phi), sin * Math.sin(phi), cos);
        });
        const geometry = gridGeometry(uv.map(([s, t]) => [(1 - Math.cos(Math.PI * s)) / 2, t]), points, indices);
        geometry.setAttribute("normal", new THREE.Float32BufferAttribute(points.flatMap((p) => p.toArray()), 3));
        const matrix = new THREE.Matrix4().makeScale(surface.radius / size, surface.radius / size, surface.radius / size);
        return { geometry, matrix: matrix.setPosition(place(surface.centre)), front: surface.inside ? 1 : 0, outline: [] };
    }
    const geometry = bench.geometries[surface.mesh];
    const mesh = block.meshes[surface.mesh];
    const m = surface.motion;
    // What the mesh was scaled and moved by, then its place in the scene, then that of the scene here.
    const origin = [0, 1, 2].map((i) => m[i] * mesh.centre[0] + m[3 + i] * mesh.centre[1] + m[6 + i] * mesh.centre[2] + m[9 + i]);
    const s = mesh.scale / size;
    const matrix = new THREE.Matrix4().set(s * m[0], s * m[3], s * m[6], 0, s * m[1], s * m[4], s * m[7], 0, s * m[2], s * m[5], s * m[8], 0, 0, 0, 0, 1);
    matrix.setPosition(place(/** @type {Point} */ (origin)));
    return { geometry, matrix, front: surface.inner ? 1 : 0, outline: mesh.triangles <= 200 ? edges(geometry, matrix) : [] };
}

/**
 * Which side of corners along u, then v, shows the normal: `FrontSide` or `BackSide`.
 * @param {Point} u
 * @param {Point} v
 * @param {Point} normal
 * @returns {0 | 1}
 */
function facing(u, v, normal) {
    const [a, b, n] = [u, v, normal].map((d) => new THREE.Vector3(...d));
    return a.normalize().cross(b.normalize()).dot(n) > 0 ? 0 : 1;
}

/**
 * @param {number[][]} uv
 * @param {Three.Vector3[]} points
 * @param {number[]} indices
 */
function gridGeometry(uv, points, indices) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(points.flatMap((p) => p.toArray()), 3));
    geometry.setAttribute("uv", new THREE.Float32BufferAttribute(uv.flat(), 2));
    geometry.setIndex(indices);
    geometry.computeVertexNormals();
    return geometry;
}

/**
 * A grid over the unit square.
 * @param {number} nu
 * @param {number} nv
 */
function squareGrid(nu, nv) {
    const uv = Array.from({ length: (nu + 1) * (nv + 1) }, (_, k) => [(k % (nu + 1)) / nu, Math.floor(k / (nu + 1)) / nv]);
    const indices = Array.from({ length: nu * nv }, (_, k) => {
        const a = (k % nu) + Math.floor(k / nu) * (nu + 1);
        return [a, a + 1, a + nu + 2, a, a + nu + 2, a + nu + 1];
    });
    return { uv, indices: indices.flat() };
}

/**
 * The equal-area map of the square to the disc of radius 1 (Shirley and Chiu, 1997): what the parameters of a disc are.
 * @param {number[]} uv
 */
function toDisc([u, v]) {
    const [a, b] = [2 * u - 1, 2 * v - 1];
    if (a === 0 && b === 0) {
        return [0, 0];
    }
    const [r, angle] = Math.abs(a) > Math.abs(b) ? [a, ((Math.PI / 4) * b) / a] : [b, Math.PI / 2 - ((Math.PI / 4) * a) / b];
    return [r * Math.cos(angle), r * Math.sin(angle)];
}

/**
 * The sides of a polygon.
 * @param {Three.Vector3[]} rim
 */
function sidesOf(rim) {
    return rim.flatMap((p, i) => [p, rim[(i + 1) % rim.length]]);
}

/**
 * The edges of a mesh at which it bends by more than 30°.
 * @param {Three.BufferGeometry} geometry
 * @param {Three.Matrix4} matrix
 */
function edges(geometry, matrix) {
    const positions = new THREE.EdgesGeometry(geometry, 30).getAttribute("position");
    return Array.from({ length: positions.count }, (_, i) => new THREE.Vector3().fromBufferAttribute(positions, i).applyMatrix4(matrix));
}

/**
 * A device's place, cut where it is too far.
 * @param {Bench} bench
 * @param {Point} position
 */
function devicePlace(bench, position) {
    return bench.place(position).clampLength(0, FARTHEST);
}

/** @typedef {"dot" | "ring" | "diamond"} MarkShape */
/**
 * A mark with a rim; its colours go on where it is transparent, so that nothing dark mixes in at its edge.
 * @param {string} fill
 * @param {string} rim
 * @param {MarkShape} shape
 */
function markTexture(fill, rim, shape) {
    const n = 48;
    const [inner, outer] = [fill, rim].map((c) => new THREE.Color(c).getHex()).map((hex) => [hex >> 16, (hex >> 8) & 255, hex & 255]);
    // The radius of the fill, and from where to where the rim goes.
    const [core, from] = shape === "ring" ? [0.42, 0.76] : [0.7, 0.7];
    const pixels = new Uint8Array(4 * n * n);
    for (let i = 0; i < n * n; i++) {
        const [x, y] = [(2 * (i % n) + 1) / n - 1, (2 * Math.floor(i / n) + 1) / n - 1];
        const r = shape === "diamond" ? Math.abs(x) + Math.abs(y) : Math.hypot(x, y);
        const within = (/** @type {number} */ radius) => Math.min(1, Math.max(0, (radius - r) * 0.5 * n + 0.5));
        pixels.set(r < (core + from) / 2 ? inner : outer, 4 * i);
        pixels[4 * i + 3] = 255 * Math.max(within(core), within(0.97) - within(from));
    }
    const texture = new THREE.DataTexture(pixels, n, n);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.magFilter = THREE.LinearFilter;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.generateMipmaps = true;
    texture.needsUpdate = true;
    return texture;
}

/**
 * Marks of one size, CSS pixels.
 * @param {Bench} bench
 * @param {Float32Array} positions
 * @param {number} size
 * @param {{ ink: Ink, mark: { rim: Ink, shape: MarkShape } }} dress
 * @param {"always" | "in front"} shown
 */
function marks(bench, positions, size, dress, shown) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    const depthTest = shown === "in front";
    const material = new THREE.PointsMaterial({ size, sizeAttenuation: false, alphaTest: 0.03, transparent: true, depthTest, depthWrite: false });
    const points = new THREE.Points(geometry, inked(bench, material, dress));
    // After everything translucent.
    points.renderOrder = depthTest ? 1 : 3;
    return points;
}

/**
 * All spots that are drawn.
 * @param {Bench} bench
 */
function addSpots(bench) {
    const { spots } = bench;
    const positions = new Float32Array(spots.length);
    for (let i = 0; i < spots.length; i += 3) {
        bench.place([spots[i], spots[i + 1], spots[i + 2]]).toArray(positions, i);
    }
    bench.parts.spots.add(marks(bench, positions, 7, { ink: "spots", mark: { rim: "ground", shape: "dot" } }, "in front"));
}

/**
 * The foot of every flat hidden surface on the first wall, if that is flat, and lines down to it: how high it hangs.
 * @param {Bench} bench
 */
function addPlumbLines(bench) {
    const { block, place, parts } = bench;
    const wall = block.surfaces.find((s) => s.role === "relay");
    if (wall === undefined || (wall.kind !== "patch" && wall.kind !== "disc")) {
        return;
    }
    const normal = new THREE.Vector3(...wall.normal);
    const on = place(wall.kind === "patch" ? wall.corner : wall.centre);
    for (const surface of block.surfaces) {
        if (surface.role === "hidden" && surface.kind === "patch") {
            const { corner, u, v } = surface;
            const rim = [corner, along(corner, u, 1), along(along(corner, u, 1), v, 1), along(corner, v, 1)].map(place);
            const feet = rim.map((p) => p.clone().addScaledVector(normal, on.clone().sub(p).dot(normal)));
            const lines = [...sidesOf(feet), ...rim.flatMap((p, i) => [p, feet[i]])];
            parts.object.add(lineSegments(bench, lines, "object", 1, { opacity: 0.45 }));
        }
    }
}

/**
 * View, lines of sight, and the two devices.
 * @param {Bench} bench
 */
function addCamera(bench) {
    const { parts, place } = bench;
    const { corner, u, v, columns, rows, position } = bench.block.camera;
    /** @type {(a: number, b: number) => Three.Vector3} */
    const at = (a, b) => place(along(along(corner, u, a), v, b));
    const rim = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
    const eye = devicePlace(bench, position);
    parts.camera.add(lineSegments(bench, sidesOf(rim), "camera", 2.5));
    parts.camera.add(lineSegments(bench, rim.flatMap((p) => [eye, p]), "camera", 1.2, { opacity: 0.55 }));
    if (columns <= 32 && rows <= 32) {
        const across = Array.from({ length: columns - 1 }, (_, i) => [at((i + 1) / columns, 0), at((i + 1) / columns, 1)]);
        const up = Array.from({ length: rows - 1 }, (_, j) => [at(0, (j + 1) / rows), at(1, (j + 1) / rows)]);
        const grid = [...across, ...up].flat();
        if (grid.length > 0) {
            parts.camera.add(lineSegments(bench, grid, "camera", 0.8, { opacity: 0.35 }));
        }
    }
    /** @type {{ rim: Ink, shape: MarkShape }} */
    const mark = { rim: "ground", shape: "diamond" };
    parts.camera.add(marks(bench, Float32Array.from(eye.toArray()), 17, { ink: "camera", mark }, "always"));
    if (bench.block.laser !== null) {
        const laser = devicePlace(bench, bench.block.laser);
        parts.beams.add(marks(bench, Float32Array.from(laser.toArray()), 13, { ink: "spots", mark }, "always"));
    }
}
