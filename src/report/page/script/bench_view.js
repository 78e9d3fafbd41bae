// How the bench is looked at: parallel projection throughout, so that every picture of it is to scale.

/** The directions of sight that have a button. @typedef {"3-D" | "Top" | "Side" | "Front"} ViewName */
/**
 * What a frame is drawn with.
 * @typedef {{ stage: HTMLElement, canvas: HTMLCanvasElement, renderer: Three.WebGLRenderer, camera: Three.OrthographicCamera, controls: Three.OrbitControls,
 *     view: ViewName, whole: boolean, turned: () => void, draw: () => void, drawn: (() => void)[] }} Sight
 * `turned` is called when another view is shown, `drawn` after every frame.
 */

/** How far the eye is from what it looks at: beyond everything that is drawn. */
const EYE = 20;
/** Free room around the bench, as shares of width and height, and CSS pixels: for names and the scale bar. */
const EDGE_MARGIN = { share: 0.07, least: 26, most: 48 };

/**
 * A renderer on `canvas`, or `undefined` where the browser has no WebGL.
 * @param {HTMLCanvasElement} canvas
 */
function rendererOn(canvas) {
    // Asked for here: three.js would complain aloud.
    const context = canvas.getContext("webgl2", { alpha: false, antialias: false, powerPreference: "low-power" });
    return context === null ? undefined : new THREE.WebGLRenderer({ canvas, context });
}

/**
 * @param {Bench} bench
 * @param {HTMLElement} stage
 * @param {HTMLCanvasElement} canvas
 * @param {Three.WebGLRenderer} renderer
 * @returns {Sight}
 */
function lookAtBench(bench, stage, canvas, renderer) {
    const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 2 * EYE);
    camera.up.set(...bench.block.up);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.enableDamping = false;
    controls.zoomToCursor = true;
    // One finger moved up or down scrolls the page; moved sideways it turns the bench, two fingers zoom and move it.
    canvas.style.touchAction = "pan-y";
    const sun = new THREE.DirectionalLight(0xffffff, 2.1);
    bench.root.add(new THREE.AmbientLight(0xffffff, 1.1), sun, sun.target);
    /** @type {Sight} */
    const sight = { stage, canvas, renderer, camera, controls, view: "3-D", whole: false, turned: () => {}, drawn: [], draw: () => {} };
    sight.draw = pacer(stage, (ratio) => {
        renderer.setPixelRatio(ratio);
        // The light comes over the eye's shoulder.
        sun.position.set(-4, 6, 10).applyQuaternion(camera.quaternion);
        renderer.render(bench.root, camera);
        sight.drawn.forEach((after) => after());
    });
    controls.addEventListener("change", sight.draw);
    return sight;
}

/** Dots per CSS pixel of a still picture, smooth without further means, and the fewest of a moving one. */
const DOTS = { still: 2, fewest: 0.5 };
/** A moving picture is drawn coarser where frames are farther apart than `slow`, and finer again below `fast`, milliseconds. */
const PACE = { slow: 27, fast: 18, still: 160 };

/**
 * Frames on demand: `draw(ratio)` at the next one, coarse enough to keep up while they follow each other, and fine once they stop. Out of sight nothing is drawn.
 * @param {HTMLElement} stage
 * @param {(ratio: number) => void} draw
 */
function pacer(stage, draw) {
    let [ratio, last, gap] = [Math.min(DOTS.still, devicePixelRatio), 0, 22];
    let waits = false;
    let rest = 0;
    const fine = () => requestAnimationFrame(() => {
        draw(DOTS.still);
        stage.dataset.still = "yes";
    });
    let [seen, stale] = [true, false];
    new IntersectionObserver((entries) => {
        seen = entries[entries.length - 1].isIntersecting;
        if (seen && stale) {
            stale = false;
            fine();
        }
    }).observe(stage);
    return () => {
        stage.dataset.still = "no";
        if (!seen) {
            stale = true;
            return;
        }
        if (waits) {
            return;
        }
        waits = true;
        clearTimeout(rest);
        requestAnimationFrame((now) => {
            waits = false;
            if (now - last < PACE.still) {
                gap += 0.25 * (now - last - gap);
                if (gap > PACE.slow && ratio > DOTS.fewest) {
                    [ratio, gap] = [Math.max(DOTS.fewest, 0.75 * ratio), 22];
                } else if (gap < PACE.fast && ratio < Math.min(DOTS.still, devicePixelRatio)) {
                    [ratio, gap] = [Math.min(DOTS.still, devicePixelRatio, 1.15 * ratio), 22];
                }
            }
            last = now;
            draw(ratio);
            rest = window.setTimeout(fine, PACE.still);
        });
    };
}

/**
 * The direction from the bench to the eye.
 * @param {Bench} bench
 * @param {ViewName} name
 */
function directionOf(bench, name) {
    const up = new THREE.Vector3(...bench.block.up);
    // What lies to the right and what lies behind in the front view: x and y where z is up; x and −z where y is.
    const right = new THREE.Vector3(up.x === 0 ? 1 : 0, up.x, 0);
    const behind = up.clone().cross(right);
    if (name === "Top") {
        // From straight above, with `behind` upwards on the screen: a millionth of a turn keeps that.
        return up.addScaledVector(behind, -1e-5).normalize();
    }
    if (name === "Side") {
        return right;
    }
    return name === "Front" ? behind.negate() : startDirection(bench, up);
}

/**
 * A direction from which both the walls and the hidden surfaces show as much of their fronts as can be, and obliquely.
 * @param {Bench} bench
 * @param {Three.Vector3} up
 */
function startDirection(bench, up) {
    const axis = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), up);
    const candidates = [20, 32].flatMap((tilt) =>
        Array.from({ length: 24 }, (_, k) => {
            const [t, phi] = [(Math.PI / 180) * tilt, (Math.PI / 12) * k + 0.2];
            return new THREE.Vector3(Math.cos(t) * Math.cos(phi), Math.cos(t) * Math.sin(phi), Math.sin(t)).applyQuaternion(axis);
        }),
    );
    const fronts = bench.block.surfaces.flatMap((s) => (s.kind === "patch" || s.kind === "disc" ? [{ role: s.role, normal: new THREE.Vector3(...s.normal) }] : []));
    const merit = (/** @type {Three.Vector3} */ d) => {
        const shown = fronts.map(({ role, normal }) => {
            const share = Math.min(0.55, normal.dot(d));
            return role === "occluder" ? 0.3 * Math.min(0, share) : role === "hidden" ? 1.2 * Math.max(-0.2, share) : 2 * Math.max(-0.3, Math.min(0.35, share));
        });
        const total = (/** @type {string} */ role) => {
            const some = shown.filter((_, i) => fronts[i].role === role);
            return some.reduce((a, b) => a + b, 0) / Math.max(1, some.length);
        };
        return total("relay") + total("hidden") + total("occluder");
    };
    return candidates.reduce((a, b) => (merit(b) > merit(a) + 1e-6 ? b : a));
}

/**
 * The names of the axes to the right and upwards on the screen in the views along an axis.
 * @param {Bench} bench
 * @param {Exclude<ViewName, "3-D">} name
 */
function planeOf(bench, name) {
    const [x, y] = bench.block.up;
    const [up, depth] = y === 1 ? ["y", "z"] : x === 1 ? ["x", "z"] : ["z", "y"];
    const across = x === 1 ? "y" : "x";
    return name === "Top" ? `${across}, ${depth}` : name === "Side" ? `${depth}, ${up}` : `${across}, ${up}`;
}

/**
 * Looks from a direction at all of the bench, or at laser and camera as well.
 * @param {Bench} bench
 * @param {Sight} sight
 * @param {ViewName} name
 */
function showView(bench, sight, name) {
    sight.view = name;
    const { camera, controls } = sight;
    camera.position.copy(controls.target).addScaledVector(directionOf(bench, name), EYE);
    camera.zoom = 1;
    controls.update();
    fitView(bench, sight);
    sight.turned();
}

/**
 * Zooms by a factor.
 * @param {Sight} sight
 * @param {number} by
 */
function zoomBy({ camera, controls, draw }, by) {
    camera.zoom = Math.min(controls.maxZoom, Math.max(controls.minZoom, camera.zoom * by));
    camera.updateProjectionMatrix();
    draw();
}

/**
 * Moves and zooms, without turning, until what is to be seen fills the drawing.
 * @param {Bench} bench
 * @param {Sight} sight
 */
function fitView(bench, sight) {
    const { camera, controls, stage } = sight;
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    const { near, laser } = bench.block;
    const corners = Array.from({ length: 8 }, (_, k) => bench.place(/** @type {Point} */ ([0, 1, 2].map((i) => near[(k >> i) & 1][i]))));
    const devices = (laser === null ? [] : [laser]).concat([bench.block.camera.position]);
    const shown = sight.whole ? [...corners, ...devices.map((p) => devicePlace(bench, p))] : corners;
    camera.updateMatrixWorld();
    const [right, up, back] = [0, 1, 2].map((i) => new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, i));
    const range = (/** @type {Three.Vector3} */ axis) => {
        const along = shown.map((p) => p.dot(axis));
        return [Math.min(...along), Math.max(...along)];
    };
    const [[left, rightmost], [lowest, top]] = [range(right), range(up)];
    const margin = (/** @type {number} */ length) => 2 * Math.min(EDGE_MARGIN.most, Math.max(EDGE_MARGIN.least, EDGE_MARGIN.share * length));
    const scale = Math.min((width - margin(width)) / Math.max(1e-9, rightmost - left), (height - 20 - margin(height)) / Math.max(1e-9, top - lowest));
    controls.target.copy(right).multiplyScalar(0.5 * (left + rightmost)).addScaledVector(up, 0.5 * (lowest + top));
    camera.position.copy(controls.target).addScaledVector(back, EYE);
    camera.zoom = Math.max(scale, 1);
    controls.minZoom = camera.zoom / 20;
    controls.maxZoom = camera.zoom * 40;
    camera.updateProjectionMatrix();
    controls.update();
    sight.draw();
}

/**
 * Takes the size of the stage.
 * @param {Sight} sight
 */
function measureStage({ renderer, camera, stage, draw }) {
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    renderer.setSize(width, height, false);
    Object.assign(camera, { left: -0.5 * width, right: 0.5 * width, top: 0.5 * height, bottom: -0.5 * height });
    camera.updateProjectionMatrix();
    draw();
}

/**
 * Where points of the scene fall on the drawing, CSS pixels from its upper left corner: x = row 0 · (p, 1), y = row 1 · (p, 1). Parallel projection is affine.
 * @param {Bench} bench
 * @param {Sight} sight
 * @returns {[number[], number[]]}
 */
function projectionOf(bench, { camera, stage }) {
    const axis = (/** @type {number} */ i) => new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, i);
    const origin = bench.place([0, 0, 0]).sub(camera.position);
    const scale = camera.zoom / bench.size;
    const row = (/** @type {Three.Vector3} */ d, /** @type {number} */ sign, /** @type {number} */ middle) => [
        ...d.toArray().map((x) => sign * x * scale),
        middle + sign * camera.zoom * origin.dot(d),
    ];
    return [row(axis(0), 1, 0.5 * stage.clientWidth), row(axis(1), -1, 0.5 * stage.clientHeight)];
}

/**
 * @param {number[]} row of a projection
 * @param {ArrayLike<number>} p
 */
function projectOn(row, p) {
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
}
