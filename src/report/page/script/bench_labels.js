// Names, axes and the scale bar, over the drawing.

/**
 * A name at a place: tried right of it, left, above and below; left out where there is no room. `reach`: a length beside which the name would be
 * too large where it is short on the screen. `axis`: along which that length lies. `device`: held at the border, with an arrow, where it is outside.
 * @typedef {{ text: string, at: () => Point | undefined, ink: Ink, part: Part | "axes", device?: boolean, reach?: number, axis?: number, element?: HTMLElement, size?: [number, number] }} Label
 */
const ARROWS = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];
/** At most so many surfaces are named. */
const MOST_NAMES = 12;
/** What is shorter on the screen, CSS pixels, gets no name, and ticks so near no numbers. */
const SHORTEST = 28;

/**
 * All names, the more important ones first.
 * @param {Bench} bench
 * @returns {Label[]}
 */
function labelsOf(bench) {
    const { block } = bench;
    const { camera, laser } = block;
    const same = laser !== null && laser.every((x, i) => x === camera.position[i]);
    /** @type {Label} */
    const own = { text: "camera", at: () => camera.position, ink: "camera", part: "camera", device: true };
    /** @type {Label[]} */
    const lit = laser === null ? [] : [{ text: same ? "laser and camera" : "laser", at: () => laser, ink: "spots", part: "beams", device: true }];
    const devices = same ? lit : [...lit, own];
    const order = { hidden: 0, relay: 1, occluder: 2 };
    const named = [...block.surfaces].sort((a, b) => order[a.role] - order[b.role] || reach(bench, b) - reach(bench, a)).slice(0, MOST_NAMES);
    return [
        { text: "chosen spot", at: () => spotPlace(bench, chosen.spot), ink: "spots", part: "spots" },
        ...devices,
        ...named.map((s) => ({ text: shortName(s.name), at: () => namePlace(bench, s), ink: partOf(s.role), part: partOf(s.role), reach: s.role === "occluder" ? 1.5 * reach(bench, s) : undefined })),
        { text: "view", at: () => along(along(camera.corner, camera.u, 1), camera.v, 1), ink: "camera", part: "camera" },
    ];
}

/**
 * @param {string} name
 */
function shortName(name) {
    return name.length > 28 ? `${name.slice(0, 27)}…` : name;
}

/**
 * About how large a surface is.
 * @param {Bench} bench
 * @param {SurfaceBlock} surface
 */
function reach({ block }, surface) {
    if (surface.kind === "sphere") {
        return surface.radius;
    }
    return surface.kind === "mesh" ? block.meshes[surface.mesh].scale * Math.hypot(...surface.motion.slice(0, 3)) : Math.hypot(...surface.u, ...surface.v);
}

/**
 * Where the name of a surface goes.
 * @param {Bench} bench
 * @param {SurfaceBlock} surface
 * @returns {Point}
 */
function namePlace({ block }, surface) {
    if (surface.kind === "patch") {
        const [a, b] = surface.role === "relay" ? [0.97, 0.06] : [1, 0.5];
        return along(along(surface.corner, surface.u, a), surface.v, b);
    }
    if (surface.kind === "mesh") {
        const { centre } = block.meshes[surface.mesh];
        const m = surface.motion;
        return /** @type {Point} */ ([0, 1, 2].map((i) => m[i] * centre[0] + m[3 + i] * centre[1] + m[6 + i] * centre[2] + m[9 + i]));
    }
    return surface.kind === "disc" ? along(surface.centre, surface.u, 1) : along(surface.centre, [0, 0.6, 0.8], surface.radius);
}

/**
 * Axes along the edges of the framed box that meet in its lowest corner, with ticks at round numbers; returns the names of axes and ticks.
 * @param {Bench} bench
 * @returns {{ lines: Three.Object3D, labels: Label[] }}
 */
function axesOf(bench) {
    const { near: [low, high], unit } = bench.block;
    const { place, size } = bench;
    /** @type {Three.Vector3[]} */
    const segments = [];
    /** @type {Label[]} */
    const ends = [];
    /** @type {Label[]} */
    const ticks = [];
    for (const i of [0, 1, 2]) {
        const at = (/** @type {number} */ x, /** @type {Point} */ off = [0, 0, 0]) =>
            /** @type {Point} */ (low.map((l, k) => (k === i ? x : l) + off[k] * size));
        const end = high[i] + 0.05 * size;
        segments.push(place(at(low[i])), place(at(end)));
        ends.push({ text: `${"xyz"[i]} / ${unit}`, at: () => at(end), ink: "soft", part: "axes", reach: high[i] - low[i], axis: i });
        const step = roundLength((high[i] - low[i] || size) / 3);
        for (let k = Math.ceil(low[i] / step - 1e-9); k * step <= high[i] + 1e-9 * step; k++) {
            for (const other of [0, 1, 2].filter((j) => j !== i)) {
                const off = /** @type {Point} */ ([0, 0, 0]);
                off[other] = -0.012;
                segments.push(place(at(k * step)), place(at(k * step, off)));
            }
            // In the corner where the axes meet three numbers would be on top of each other.
            if (k * step > low[i] + 1e-9 * step) {
                ticks.push({ text: plainNumber(k * step), at: () => at(k * step), ink: "soft", part: "axes", reach: step, axis: i });
            }
        }
    }
    return { lines: lineSegments(bench, segments, "soft", 1.2), labels: [...ends, ...ticks] };
}

/**
 * The largest of 1, 2, 5 · 10ⁿ that is no more than x > 0.
 * @param {number} x
 */
function roundLength(x) {
    const power = 10 ** Math.floor(Math.log10(x));
    return ([5, 2].find((m) => m * power <= x * (1 + 1e-9)) ?? 1) * power;
}

/**
 * A round number without superfluous digits.
 * @param {number} x
 */
function plainNumber(x) {
    const text = Math.abs(x) >= 1e5 || (x !== 0 && Math.abs(x) < 1e-3) ? x.toExponential() : String(Number(x.toPrecision(6)));
    return text.replace("-", "−").replace("e+", "e");
}

/**
 * Puts the names where they belong in the frame just drawn.
 * @param {Bench} bench
 * @param {Sight} sight
 * @param {HTMLElement} layer
 * @param {Label[]} labels
 */
function placeLabels(bench, sight, layer, labels) {
    const [across, down] = projectionOf(bench, sight);
    const [width, height] = [sight.stage.clientWidth, sight.stage.clientHeight];
    // Kept free: the scale bar.
    const taken = [[0, height - 30, 270, height]];
    const { near: [low, high] } = bench.block;
    /** Points of the axes, of which names keep off. */
    const dots = [0, 1, 2].flatMap((i) => Array.from({ length: 61 }, (_, k) => {
        const p = low.map((l, j) => (j === i ? l + (k / 60) * (high[i] + 0.05 * bench.size - l) : l));
        return { axis: i, x: projectOn(across, p), y: projectOn(down, p) };
    }));
    for (const label of labels) {
        const [alongX, alongY] = label.axis === undefined ? [sight.camera.zoom / bench.size, 0] : [across[label.axis], down[label.axis]];
        const short = label.reach !== undefined && label.reach * Math.hypot(alongX, alongY) < SHORTEST;
        const place = short ? undefined : label.part === "axes" || bench.parts[label.part].visible ? label.at() : undefined;
        const element = (label.element ??= layer.appendChild(make("span", { style: `color: color-mix(in srgb, var(${INKS[label.ink]}) 75%, var(--ink))` }, label.text)));
        if (place === undefined) {
            element.hidden = true;
            continue;
        }
        let [x, y] = [projectOn(across, place), projectOn(down, place)];
        const outside = x < 0 || y < 0 || x > width || y > height;
        if (label.device) {
            const text = outside ? `${label.text} ${arrowTo(x - width / 2, height / 2 - y)}` : label.text;
            if (element.textContent !== text) {
                element.textContent = text;
                label.size = undefined;
            }
            if (outside) {
                const t = Math.min(0.5 * width / Math.abs(x - 0.5 * width), 0.5 * height / Math.abs(y - 0.5 * height));
                [x, y] = [0.5 * width + t * (x - 0.5 * width), 0.5 * height + t * (y - 0.5 * height)];
            }
        }
        element.hidden = false;
        const [w, h] = (label.size ??= [element.offsetWidth, element.offsetHeight]);
        const [right, left, above, below] = [[x + 8, y - h / 2], [x - 8 - w, y - h / 2], [x - w / 2, y - h - 6], [x - w / 2, y + 6]];
        const sides = [right, left, above, below, [x + 6, y - h - 4], [x - w - 6, y + 4]];
        // The numbers of an axis stand below or left of it, its name goes on where it ends.
        const tick = label.axis !== undefined && !label.text.includes("/");
        const tried = !tick ? sides : Math.abs(alongX) > Math.abs(alongY) ? [below, ...sides] : [left, ...sides];
        const fits = tried.filter(
            ([a, b]) => a >= 2 && b >= 2 && a + w <= width - 2 && b + h <= height - 2 && !taken.some((t) => a < t[2] && a + w > t[0] && b < t[3] && b + h > t[1]),
        );
        const clear = (/** @type {number[]} */ [a, b]) => label.axis === undefined || !dots.some((d) => d.axis !== label.axis && d.x > a - 2 && d.x < a + w + 2 && d.y > b && d.y < b + h);
        const free = fits.find(clear) ?? fits[0];
        element.hidden = free === undefined;
        if (free !== undefined) {
            const [a, b] = free;
            element.style.transform = `translate(${a.toFixed(1)}px, ${b.toFixed(1)}px)`;
            taken.push([a - 2, b, a + w + 2, b + h]);
        }
    }
}

/**
 * The arrow nearest to a direction, y upwards.
 * @param {number} x
 * @param {number} y
 */
function arrowTo(x, y) {
    return ARROWS[(Math.round(Math.atan2(y, x) / (Math.PI / 4)) + 8) % 8];
}

/**
 * A bar of a round length; lengths parallel to the screen are to its scale.
 * @param {Bench} bench
 * @param {Sight} sight
 * @param {HTMLElement} bar
 */
function placeScale(bench, { camera, view, stage }, bar) {
    const scale = camera.zoom / bench.size;
    const length = roundLength(Math.min(130, 0.3 * stage.clientWidth) / scale);
    const [line, words] = /** @type {HTMLElement[]} */ ([...bar.children]);
    line.style.width = `${(length * scale).toFixed(2)}px`;
    const text = `${plainNumber(length)} ${bench.block.unit}${view === "3-D" ? " along the screen" : ""}`;
    if (words.textContent !== text) {
        words.textContent = text;
    }
}
