// A plot that answers: Observable Plot draws it with the look of the static figures; hover, touch and arrow keys say its values.

/**
 * `points` are pairs, or columns where there are many; `low` and `high` are the ends of a band around the line.
 * @typedef {(number | null)[][] | { x: ArrayLike<number>, y: ArrayLike<number> }} PlotPoints
 * @typedef {{ name: string, look: number, kind?: "line" | "points" | "published", points: PlotPoints,
 *     low?: ArrayLike<number>, high?: ArrayLike<number>, hidden?: boolean }} PlotSeries
 * @typedef {{ title?: string, x: PlotAxis, y: PlotAxis, series: PlotSeries[], marked?: number[], height?: number,
 *     onPick?: (x: number, series: PlotSeries) => void }} PlotSpec
 * @typedef {{ spec: PlotSpec, svg: () => SVGSVGElement, update: (change: Partial<PlotSpec>) => void }} DrawnPlot
 */

/** More points of a line than this are not all marked. */
const MOST_MARKS = 40;
const MARGIN = { top: 8, right: 16, bottom: 46, left: 62 };

/** @type {WeakMap<object, { xs: ArrayLike<number>, ys: ArrayLike<number> }>} */
const knownColumns = new WeakMap();

/**
 * The coordinates of a series; what is not known is NaN.
 * @param {PlotSeries} series
 */
function columns({ points }) {
    if (!Array.isArray(points)) {
        return { xs: points.x, ys: points.y };
    }
    let found = knownColumns.get(points);
    if (found === undefined) {
        const column = (/** @type {number} */ d) => Float64Array.from(points, (p) => p[d] ?? NaN);
        found = { xs: column(0), ys: column(1) };
        knownColumns.set(points, found);
    }
    return found;
}

/**
 * What a legend calls a series.
 * @param {PlotSeries} series
 */
function legendText(series) {
    return series.kind === "published" ? `${series.name} (published)` : series.name;
}

/**
 * The ends of an axis of a plot.
 * @param {PlotSpec} spec
 * @param {"x" | "y"} side
 */
function plotEnds(spec, side) {
    const { run, ends } = spec[side];
    if (ends !== undefined) {
        return ends;
    }
    return endsOf(run, (function* () {
        for (const series of spec.series) {
            const { xs, ys } = columns(series);
            for (const values of side === "x" ? [xs] : [ys, series.low ?? [], series.high ?? []]) {
                for (let i = 0; i < values.length; i++) {
                    yield values[i];
                }
            }
        }
    })());
}

/**
 * Draws a plot as SVG.
 * @param {PlotSpec} spec
 * @param {number} width
 */
function plotElement(spec, width) {
    const height = spec.height ?? Math.round(Math.min(360, Math.max(230, 0.66 * width)));
    const [x, y] = /** @type {const} */ (["x", "y"]).map((side) => plotEnds(spec, side));
    const [ticksX, ticksY] = [ticksOf(spec.x.run, x, width < 420 ? 5 : 7), ticksOf(spec.y.run, y, 7)];
    // Ticks that are long have room.
    const longest = Math.max(0, ...Array.from(ticksY.values(), (text) => [...text].reduce((sum, c) => sum + (RAISED.has(c) ? 5.6 : 8), 0)));
    const left = Math.max(MARGIN.left, 36 + longest);
    const [slackX, slackY] = [slack(spec.x.run, x), slack(spec.y.run, y)];
    const inside = (/** @type {number} */ a, /** @type {number} */ b) => a >= slackX[0] && a <= slackX[1] && b >= slackY[0] && b <= slackY[1];
    const grid = { stroke: "#d0d0d0", strokeOpacity: 1, strokeWidth: 0.6 };
    /** @type {any[]} */
    const marks = [Plot.gridX([...ticksX.keys()], grid), Plot.gridY([...ticksY.keys()], grid), Plot.frame({ stroke: "#222222", strokeWidth: 0.9 })];
    const dots = [];
    for (const series of spec.series.filter((s) => s.hidden !== true)) {
        const { xs, ys } = columns(series);
        const { ink, dash, outline, fill, stroke, width: strokeWidth } = lookOf(series);
        const each = series.kind === "line" || series.kind === undefined ? Math.max(1, Math.ceil(xs.length / MOST_MARKS)) : 1;
        const shown = Array.from({ length: xs.length }, (_, i) => i).filter((i) => inside(xs[i], ys[i])).filter((_, k) => k % each === 0);
        const at = (/** @type {number[]} */ rows) => ({ x: rows.map((i) => xs[i]), y: rows.map((i) => ys[i]) });
        if (series.kind === "points") {
            dots.push(Plot.dot(shown, { ...at(shown), r: 1.8, fill: ink, fillOpacity: 0.5, stroke: "none" }));
            continue;
        }
        if (series.kind !== "published") {
            if (series.low !== undefined && series.high !== undefined) {
                const within = (/** @type {number} */ v) => Math.min(y[1], Math.max(y[0], v));
                const band = thinnedBand(xs, series.low, series.high, width);
                marks.push(Plot.areaY(band.x, { x: band.x, y1: band.low.map(within), y2: band.high.map(within), fill: ink, fillOpacity: 0.18 }));
            }
            // Beyond the axes there is no line.
            const line = Float64Array.from(ys, (v, i) => (inside(xs[i], v) ? v : NaN));
            const rows = thinned(line, width);
            marks.push(Plot.line(rows, { x: rows.map((i) => xs[i]), y: rows.map((i) => line[i]), stroke: ink, strokeWidth: 1.6, strokeLinejoin: "round", strokeDasharray: dash || undefined }));
        }
        dots.push(Plot.dot(shown, { ...at(shown), r: 3, symbol: /** @type {any} */ (symbolOf(outline)), fill, stroke, strokeWidth }));
    }
    const scale = (/** @type {AxisRun} */ run, /** @type {[number, number]} */ domain, /** @type {Map<number, string>} */ ticks) => ({
        type: run === "logarithmic" ? /** @type {const} */ ("log") : /** @type {const} */ ("linear"),
        domain,
        ticks: [...ticks.keys()],
        tickFormat: (/** @type {number} */ t) => ticks.get(t) ?? "",
        tickSize: 0,
        tickPadding: 8,
        label: null,
    });
    const svg = /** @type {SVGSVGElement & { scale: (name: string) => any }} */ (Plot.plot({
        width,
        height,
        marginTop: MARGIN.top,
        marginRight: MARGIN.right,
        marginBottom: MARGIN.bottom,
        marginLeft: left,
        style: { fontFamily: FAMILIES, fontSize: "13px", color: "#222222", background: "none", overflow: "visible" },
        x: scale(spec.x.run, x, ticksX),
        y: scale(spec.y.run, y, ticksY),
        marks: [...marks, ...dots],
    }));
    svg.querySelectorAll("text").forEach((text) => setRaised(text, text.textContent ?? ""));
    const across = [left, width - MARGIN.right];
    const up = [MARGIN.top, height - MARGIN.bottom];
    axisTitle(svg, spec.x.title, across[1] - across[0], `translate(${(across[0] + across[1]) / 2} ${height - 8})`);
    axisTitle(svg, spec.y.title, up[1] - up[0], `translate(14 ${(up[0] + up[1]) / 2}) rotate(-90)`);
    svg.setAttribute("aria-hidden", "true");
    const place = (/** @type {"x" | "y"} */ side) => svg.scale(side).apply;
    return { svg, width, height, across, up, place: { x: place("x"), y: place("y") }, inside };
}

/**
 * The title of an axis, set smaller where it would be longer than the axis.
 * @param {SVGSVGElement} svg
 * @param {string} title
 * @param {number} room
 * @param {string} transform
 */
function axisTitle(svg, title, room, transform) {
    const size = Math.max(9, Math.min(13, (room + 40) / (0.58 * Math.max(1, title.length))));
    const text = makeSvg("text", { transform, "text-anchor": "middle", "font-size": size, fill: "#222222" });
    setRaised(text, title);
    svg.append(text);
}

/**
 * Ends with the last digits' worth of room.
 * @param {AxisRun} run
 * @param {[number, number]} ends
 * @returns {[number, number]}
 */
function slack(run, [low, high]) {
    const beyond = 1e-9 * (run === "logarithmic" ? Math.log(high / low) : high - low);
    return run === "logarithmic" ? [low * (1 - beyond), high * (1 + beyond)] : [low - beyond, high + beyond];
}

/**
 * Puts a plot into an element and keeps it as wide. `update` changes what is said of it and draws it again before the next frame; of the marked places alone that takes no drawing.
 * @param {HTMLElement} container
 * @param {PlotSpec} given
 * @returns {DrawnPlot}
 */
function drawPlot(container, given) {
    const spec = { ...given };
    const picture = make("div", { class: "picture" });
    const said = make("p", { class: "read", "aria-live": "polite" });
    container.classList.add("plotted");
    container.append(picture, said);
    let drawn = plotElement(spec, Math.round(container.clientWidth) || 480);
    let waiting = false;
    const reader = readPlot(picture, said, () => drawn, spec);
    const show = () => {
        picture.querySelector("svg")?.remove();
        picture.prepend(drawn.svg);
        markPlaces(drawn, spec.marked ?? []);
        reader.again();
    };
    const draw = () => {
        waiting = false;
        drawn = plotElement(spec, Math.round(container.clientWidth) || drawn.width);
        show();
    };
    const later = () => {
        if (!waiting) {
            waiting = true;
            requestAnimationFrame(draw);
        }
    };
    show();
    new ResizeObserver(() => {
        if (container.clientWidth > 0 && Math.round(container.clientWidth) !== drawn.width) {
            later();
        }
    }).observe(container);
    return {
        spec,
        svg: () => drawn.svg,
        update(change) {
            Object.assign(spec, change);
            if (Object.keys(change).every((key) => key === "marked")) {
                markPlaces(drawn, spec.marked ?? []);
            } else {
                later();
            }
        },
    };
}

/**
 * Draws upright lines at marked places.
 * @param {ReturnType<typeof plotElement>} drawn
 * @param {number[]} places
 */
function markPlaces({ svg, place, across, up }, places) {
    svg.querySelector(".marked")?.remove();
    const lines = places.map((x) => place.x(x)).filter((x) => x >= across[0] - 1 && x <= across[1] + 1);
    const path = lines.map((x) => `M${x} ${up[0]}V${up[1]}`).join("");
    svg.append(makeSvg("g", { class: "marked" }, makeSvg("path", { d: path, stroke: "#222222", "stroke-width": 1.2, "stroke-dasharray": "5 3", fill: "none" })));
}
