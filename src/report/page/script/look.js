// How series look: the inks, dashes and marks of the static figures (look.rs), which hands them over.

/** @typedef {number | [number, number][]} Outline a radius, or corners */

/** @type {{ inks: string[], dashes: string[], marks: Outline[], printed: Outline[] } | undefined} */
let allLooks;

function looks() {
    allLooks ??= /** @type {NonNullable<typeof allLooks>} */ (data("looks"));
    return allLooks;
}

/**
 * Ink, dash and mark of a series by its number, as in a static figure.
 * @param {PlotSeries} series
 */
function lookOf({ look, kind }) {
    const { inks, dashes, marks, printed } = looks();
    if (kind === "published") {
        return { ink: "#222222", dash: "", outline: printed[look % printed.length], fill: "none", stroke: "#222222", width: 1.3 };
    }
    const ink = inks[look % inks.length];
    const turn = Math.floor(look / inks.length);
    const hollow = turn % 2 === 1;
    return {
        ink,
        dash: dashes[(look + turn) % dashes.length],
        outline: marks[look % marks.length],
        fill: hollow ? "#ffffff" : ink,
        stroke: hollow ? ink : "none",
        width: hollow ? 1.2 : 0,
    };
}

/**
 * The outline as a symbol of Observable Plot, which draws it on a path.
 * @param {Outline} outline
 */
function symbolOf(outline) {
    return {
        draw(/** @type {any} */ path) {
            if (typeof outline === "number") {
                path.moveTo(outline, 0);
                path.arc(0, 0, outline, 0, 2 * Math.PI);
                return;
            }
            outline.forEach(([x, y], i) => (i === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
            path.closePath();
        },
    };
}

/**
 * The same as the data of an SVG path around a point.
 * @param {Outline} outline
 * @param {[number, number]} at
 */
function outlinePath(outline, [x, y]) {
    if (typeof outline === "number") {
        return `M${x - outline} ${y}a${outline} ${outline} 0 1 0 ${2 * outline} 0a${outline} ${outline} 0 1 0 ${-2 * outline} 0Z`;
    }
    return `M${outline.map(([dx, dy]) => `${x + dx} ${y + dy}`).join("L")}Z`;
}

/**
 * A sample of a series for a legend, 34 × 16.
 * @param {PlotSeries} series
 * @returns {SVGGElement}
 */
function sampleOf(series) {
    const { ink, dash, outline, fill, stroke, width } = lookOf(series);
    const sample = makeSvg("g");
    if (series.kind === "points") {
        sample.append(makeSvg("circle", { cx: 17, cy: 8, r: 3.2, fill: ink, "fill-opacity": 0.7 }));
        return sample;
    }
    if (series.kind !== "published") {
        sample.append(makeSvg("path", { d: "M2 8H32", stroke: ink, "stroke-width": 1.6, "stroke-dasharray": dash || undefined, fill: "none" }));
    }
    sample.append(makeSvg("path", { d: outlinePath(outline, [17, 8]), fill, stroke, "stroke-width": width }));
    return sample;
}
