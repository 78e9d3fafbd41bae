// The wall seen from the camera: spots and view to scale; a click chooses a spot or a pixel.

/**
 * @param {Circumstances} about
 * @param {Source} source
 * @param {(x: number, y: number) => void} pick what to do with a pixel that is pointed at
 */
function plan(about, source, pick) {
    const dot = (/** @type {number[]} */ a, /** @type {number[]} */ b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const { right, up } = about.axes;
    const corner = [dot(about.view.corner, right), dot(about.view.corner, up)];
    const size = [dot(about.view.u, right), dot(about.view.v, up)];
    const normal = [right[1] * up[2] - right[2] * up[1], right[2] * up[0] - right[0] * up[2], right[0] * up[1] - right[1] * up[0]];
    const level = dot(about.view.corner, normal);
    const near = 1e-4 * (Math.abs(size[0]) + Math.abs(size[1]));
    /** Where spots lie on the wall in view; those on other walls are not on this drawing. */
    const places = about.places.map((p) => (Math.abs(dot(p, normal) - level) <= near ? [dot(p, right), dot(p, up)] : null));
    const here = places.flatMap((p) => (p === null ? [] : [p]));
    const xs = [corner[0], corner[0] + size[0], ...here.map((p) => p[0])];
    const ys = [corner[1], corner[1] + size[1], ...here.map((p) => p[1])];
    const [left, bottom] = [Math.min(...xs), Math.min(...ys)];
    const span = Math.max(Math.max(...xs) - left, Math.max(...ys) - bottom) || 1;
    const room = 300;
    const scale = room / span;
    const margin = 16;
    const width = scale * (Math.max(...xs) - left) + 2 * margin;
    const height = scale * (Math.max(...ys) - bottom) + 2 * margin;
    const at = (/** @type {number[]} */ p) => [margin + scale * (p[0] - left), height - margin - scale * (p[1] - bottom)];

    const svg = makeSvg("svg", { viewBox: `0 0 ${width} ${height}`, class: "plan", role: "img", "aria-label": "The wall: laser spots, and the camera's view" });
    const [vx, vy] = at([corner[0], corner[1] + size[1]]);
    const view = makeSvg("rect", { x: vx, y: vy, width: scale * size[0], height: scale * size[1], class: "view" });
    view.append(makeSvg("title", {}, "the camera's view: click chooses a pixel"));
    view.addEventListener("click", (event) => {
        const box = view.getBoundingClientRect();
        const share = [(event.clientX - box.left) / box.width, (box.bottom - event.clientY) / box.height];
        pick(Math.floor(share[0] * about.columns), Math.floor(share[1] * about.rows));
    });
    svg.append(view);
    const pixel = makeSvg("rect", { class: "pixel" });
    const radius = Math.min(4.5, Math.max(1.6, 90 / Math.sqrt(here.length)));
    const spots = makeSvg("g", { class: "spots" });
    source.spots.forEach((spot) => {
        const found = places[spot];
        if (found === undefined || found === null) {
            return;
        }
        const [cx, cy] = at(found);
        const title = makeSvg("title", {}, `spot ${spot} at ${place(about, spot)}`);
        spots.append(makeSvg("circle", { cx, cy, r: radius, click: () => choose({ spot }) }, title));
    });
    const ring = makeSvg("circle", { r: radius + 4, class: "ring" });
    svg.append(spots, pixel, ring);

    const element = make(
        "figure",
        { class: "plan" },
        svg,
        make("figcaption", {}, `The wall as the camera sees it, to scale, ${round(span)} ${about.unit} across: spots (click one) and the view (click a pixel).${here.length < places.length ? ` ${places.length - here.length} spots on other walls are not drawn here.` : ""}`),
    );
    return {
        element,
        show(/** @type {{ spot: number, pixel: number }} */ { spot, pixel: index }) {
            const found = places[spot] ?? undefined;
            ring.style.display = found === undefined ? "none" : "";
            if (found !== undefined) {
                const [cx, cy] = at(found);
                ring.setAttribute("cx", String(cx));
                ring.setAttribute("cy", String(cy));
            }
            const [column, row] = [index % about.columns, Math.floor(index / about.columns)];
            const step = [size[0] / about.columns, size[1] / about.rows];
            const [x, y] = at([corner[0] + column * step[0], corner[1] + (row + 1) * step[1]]);
            const [w, h] = [Math.max(scale * step[0], 3), Math.max(scale * step[1], 3)];
            pixel.setAttribute("x", String(x));
            pixel.setAttribute("y", String(y));
            pixel.setAttribute("width", String(w));
            pixel.setAttribute("height", String(h));
        },
    };
}

/**
 * Three digits without zeros that say nothing.
 * @param {number} x
 */
function round(x) {
    return String(Number(x.toPrecision(3))).replace("-", "−");
}

/**
 * Where a spot lies, with its unit.
 * @param {Circumstances} about
 * @param {number} spot
 */
function place(about, spot) {
    const found = about.places[spot];
    return found === undefined ? "" : `(${found.map(round).join(", ")}) ${about.unit}`;
}
