// What is chosen on the bench: by click or tap, and how the drawing shows it.

/** A click this near to a spot, CSS pixels, means it; a finger is less exact. */
const NEAR = { mouse: 9, touch: 20 };
/** A pointer that moved no farther between down and up has clicked, CSS pixels. */
const STILL = 5;

/**
 * The spot nearest to a place of the drawing within `reach`, or the pixel of the view under it.
 * @param {Bench} bench
 * @param {[number[], number[]]} rows the projection
 * @param {[number, number]} at
 * @param {number} reach
 * @returns {{ spot?: number, pixel?: number }}
 */
function under(bench, rows, [x, y], reach) {
    let [nearest, spot] = [reach * reach, -1];
    const { spots } = bench;
    for (let i = 0; i < spots.length; i += 3) {
        const [dx, dy] = rows.map((row, k) => row[0] * spots[i] + row[1] * spots[i + 1] + row[2] * spots[i + 2] + row[3] - (k === 0 ? x : y));
        if (dx * dx + dy * dy < nearest) {
            [nearest, spot] = [dx * dx + dy * dy, i / 3];
        }
    }
    if (spot >= 0 && bench.parts.spots.visible) {
        return { spot: spot * bench.block.spots.step };
    }
    const { corner, u, v, columns, rows: lines } = bench.block.camera;
    const [px, py] = rows.map((row) => projectOn(row, corner));
    const [[ux, uy], [vx, vy]] = [u, v].map((d) => rows.map((row) => row[0] * d[0] + row[1] * d[1] + row[2] * d[2]));
    const area = ux * vy - uy * vx;
    const a = ((x - px) * vy - (y - py) * vx) / area;
    const b = ((y - py) * ux - (x - px) * uy) / area;
    const inside = a >= 0 && a < 1 && b >= 0 && b < 1;
    return inside && bench.parts.camera.visible ? { pixel: Math.floor(a * columns) + Math.floor(b * lines) * columns } : {};
}

/**
 * Clicks and taps choose.
 * @param {Bench} bench
 * @param {Sight} sight
 */
function chooseByPointer(bench, sight) {
    const { canvas } = sight;
    /** @type {{ id: number, x: number, y: number } | undefined} */
    let down;
    canvas.addEventListener("pointerdown", (event) => {
        down = event.isPrimary && event.button === 0 ? { id: event.pointerId, x: event.clientX, y: event.clientY } : undefined;
    });
    canvas.addEventListener("pointerup", (event) => {
        const still = down?.id === event.pointerId && Math.hypot(event.clientX - down.x, event.clientY - down.y) <= STILL;
        down = undefined;
        if (still) {
            const box = canvas.getBoundingClientRect();
            const reach = event.pointerType === "touch" ? NEAR.touch : NEAR.mouse;
            const choice = under(bench, projectionOf(bench, sight), [event.clientX - box.left, event.clientY - box.top], reach);
            if (choice.spot !== undefined || choice.pixel !== undefined) {
                choose(choice);
            }
        }
    });
}

/**
 * The place of a spot, or `undefined` if it is not drawn.
 * @param {Bench} bench
 * @param {number} spot
 * @returns {Point | undefined}
 */
function spotPlace({ block, spots }, spot) {
    const i = (3 * spot) / block.spots.step;
    return Number.isInteger(i / 3) && i >= 0 && i < spots.length ? [spots[i], spots[i + 1], spots[i + 2]] : undefined;
}

/**
 * Point (a, b) of a pixel's footprint, 0 ≤ a, b ≤ 1.
 * @param {CameraBlock} camera
 * @param {number} pixel
 * @param {[number, number]} [at]
 * @returns {Point}
 */
function pixelPlace({ corner, u, v, columns, rows }, pixel, [a, b] = [0.5, 0.5]) {
    return along(along(corner, u, ((pixel % columns) + a) / columns), v, (Math.floor(pixel / columns) + b) / rows);
}

/**
 * Follows what is chosen: marks of spot and pixel, the beam, the ways of the light over a few points of the object as far as they are free, the line of sight.
 * Returns a function that shows a choice and says it in words.
 * @param {Bench} bench
 */
function followChoice(bench) {
    const { place, parts, block, ways } = bench;
    const changing = { spots: new THREE.Group(), beams: new THREE.Group(), camera: new THREE.Group() };
    for (const part of /** @type {("spots" | "beams" | "camera")[]} */ (Object.keys(changing))) {
        parts[part].add(changing[part]);
    }
    const ring = marks(bench, new Float32Array(3), 19, { ink: "spots", mark: { rim: "walls", shape: "ring" } }, "always");
    const eye = devicePlace(bench, block.camera.position);
    const laser = block.laser === null ? undefined : devicePlace(bench, block.laser);
    return (/** @type {{ spot: number, pixel: number }} */ { spot, pixel }) => {
        for (const group of Object.values(changing)) {
            group.children.forEach((child) => (child === ring ? undefined : release(child)));
            group.clear();
        }
        const from = spotPlace(bench, spot);
        const to = pixelPlace(block.camera, pixel);
        const quad = /** @type {[number, number][]} */ ([[0, 0], [1, 0], [1, 1], [0, 1]]).map((at) => place(pixelPlace(block.camera, pixel, at)));
        const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true, opacity: 0.8, depthWrite: false });
        inked(bench, material, { ink: "camera" });
        changing.camera.add(new THREE.Mesh(gridGeometry([[0, 0], [1, 0], [1, 1], [0, 1]], quad, [0, 1, 2, 0, 2, 3]), material));
        changing.camera.add(lineSegments(bench, sidesOf(quad), "camera", 2, { always: true }));
        changing.beams.add(lineSegments(bench, [place(to), eye], "camera", 2, { always: true }));
        const all = block.ways.points.length;
        const free = (/** @type {number} */ count) => (all === 0 || !ways.pixels ? "" : ` Of ${all} ways over the object ${count === all ? "all" : count} ${count === 1 ? "is" : "are"} free.`);
        if (laser === undefined) {
            const seen = ways.pixels ? ways.pixels[pixel] : 0;
            const open = block.ways.points.filter((_, k) => ((seen >> k) & 1) === 1);
            if (open.length > 0) {
                changing.beams.add(lineSegments(bench, open.flatMap((p) => [place(p), place(to)]), "object", 1.6, { opacity: 0.9, always: true }));
            }
            return `${pixelWords(block, pixel)}${free(open.length)}`;
        }
        if (from === undefined) {
            return `Spot ${spot} is not among those drawn. ${pixelWords(block, pixel)}`;
        }
        place(from).toArray(/** @type {any} */ (ring.geometry.getAttribute("position")).array);
        ring.geometry.getAttribute("position").needsUpdate = true;
        ring.frustumCulled = false;
        changing.spots.add(ring);
        changing.beams.add(lineSegments(bench, [laser, place(from)], "spots", 2, { always: true }));
        const seen = ways.pixels ? ways.spots[spot / block.spots.step] & ways.pixels[pixel] : 0;
        const open = block.ways.points.filter((_, k) => ((seen >> k) & 1) === 1);
        const pairs = open.flatMap((p) => [place(from), place(p), place(p), place(to)]);
        if (pairs.length > 0) {
            changing.beams.add(lineSegments(bench, pairs, "object", 1.6, { opacity: 0.9, always: true }));
        }
        return `Spot ${spot} at ${pointWords(from, block.unit)}. ${pixelWords(block, pixel)}${free(open.length)}`;
    };
}

/**
 * @param {BenchBlock} block
 * @param {number} pixel
 */
function pixelWords({ camera, unit }, pixel) {
    return `Pixel ${pixel} (column ${pixel % camera.columns}, row ${Math.floor(pixel / camera.columns)}) sees ${pointWords(pixelPlace(camera, pixel), unit)}.`;
}

/**
 * @param {ArrayLike<number>} p
 * @param {string} unit
 */
function pointWords(p, unit) {
    const text = Array.from(p, (x) => significant(Math.abs(x) < 1e-12 ? 0 : x, 3));
    return `(${text.join(", ")}) ${unit}`;
}

/**
 * Gives back what a drawn object holds on the graphics side.
 * @param {any} object
 */
function release(object) {
    object.geometry?.dispose();
    object.material?.dispose();
}
