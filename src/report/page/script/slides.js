// The recoveries over method, regularisation and noise: see `gallery/slides.rs`, which writes the frame and the data.

/**
 * MTF raw, MTF normalized, correlation, root mean square error; `null` where one is not defined.
 * @typedef {[number | null, number | null, number | null, number | null]} Measures
 */
/** @typedef {{ name: string, elements: [number, number], cells: boolean, first: number }} SlideSurface */
/**
 * @typedef {object} SlideSeries
 * @property {string} method
 * @property {string | null} meaning
 * @property {string[]} steps parameters in words, from the strongest regularisation to the weakest
 * @property {{ step?: number, words?: string, why?: string }[]} automatic for each noise
 * @property {(number | null)[][]} pictures for each noise and step: which of the packed pictures
 * @property {Measures[][][]} measures for each noise, step and surface
 */
/** @typedef {{ elements: number, surfaces: SlideSurface[], noises: number[], mean: number, series: SlideSeries[] }} Slides */

upgrade("#slides", async (element) => {
    const slides = /** @type {Slides} */ (data("slides-data"));
    const values = await numbers("slides-values");
    if (values === undefined) {
        return;
    }
    const show = (/** @type {string} */ name) => /** @type {HTMLElement} */ (element.querySelector(`[data-show="${name}"]`));
    const input = (/** @type {string} */ name) => /** @type {HTMLInputElement} */ (element.querySelector(`[name="${name}"]`));
    const [surface, method] = ["surface", "method"].map((name) => /** @type {HTMLSelectElement} */ (element.querySelector(`select[name="${name}"]`)));
    const [step, noise, automatic, stretched] = ["step", "noise", "automatic", "stretched"].map(input);
    surface.append(...slides.surfaces.map((of, i) => make("option", { value: i }, of.name)));
    method.append(...slides.series.map((of, i) => make("option", { value: i }, of.method)));
    // What the run itself is judged by comes last, and is shown first.
    method.selectedIndex = slides.series.length - 1;
    noise.max = String(slides.noises.length - 1);

    /**
     * The values of a packed picture on a surface.
     * @param {number} picture
     * @param {SlideSurface} of
     */
    const valuesOf = (picture, of) => {
        const first = picture * slides.elements + of.first;
        return values.subarray(first, first + of.elements[0] * of.elements[1]);
    };

    const update = () => {
        const series = slides.series[method.selectedIndex];
        const of = slides.surfaces[surface.selectedIndex];
        const level = Number(noise.value);
        const chosen = series.automatic[level];
        const own = chosen.step;
        show("meaning").textContent = series.meaning === null ? "" : `${series.method}: ${series.meaning}.`;
        step.max = String(series.steps.length - 1);
        step.disabled = series.steps.length === 1;
        if (automatic.checked && own !== undefined) {
            step.value = String(own);
        }
        const at = Number(step.value);
        const words = at === own && chosen.words !== undefined ? chosen.words : series.steps[at];
        step.setAttribute("aria-valuetext", readable(series.steps[at]));
        show("step").textContent = readable(series.steps[at]);
        const added = noiseWords(slides.noises[level]);
        noise.setAttribute("aria-valuetext", added);
        const watts = slides.noises[level] > 0 ? ` (${significant(slides.noises[level] * slides.mean, 2)} W)` : "";
        show("noise").textContent = added + watts;
        markAutomatic(show("marker"), own, series.steps.length);
        const picture = series.pictures[level][at];
        const missing = picture === null ? `Nothing is recovered here: ${chosen.why ?? "the method gave nothing"}.` : "";
        const undecided = automatic.checked && chosen.why !== undefined ? `The method does not choose a parameter here: ${chosen.why}.` : "";
        show("said").textContent = readable(missing || undecided);
        show("parameter").textContent = picture === null ? "" : readable(words);
        const [raw, normalized, correlation, rmse] = series.measures[level][at][surface.selectedIndex] ?? [null, null, null, null];
        for (const [name, value] of Object.entries({ raw, normalized, correlation, rmse })) {
            show(name).textContent = significant(value, 3);
        }
        element.dataset.picture = picture === null ? "" : String(picture);
        paintBoth(of, picture);
        const steps = series.automatic.map((a) => (automatic.checked ? a.step : at));
        show("curves").replaceChildren(...slideCurves(slides, series, steps, surface.selectedIndex, level));
    };

    /**
     * @param {SlideSurface} of
     * @param {number | null} picture
     */
    const paintBoth = (of, picture) => {
        for (const figure of /** @type {NodeListOf<HTMLElement>} */ (element.querySelectorAll("figure[data-picture]"))) {
            figure.hidden = !of.cells;
        }
        show("element").hidden = !of.cells;
        if (!of.cells) {
            return;
        }
        const [recovered, truth] = ["picture", "truth"].map((name) => /** @type {HTMLCanvasElement} */ (show(name)));
        paint(truth, valuesOf(0, of), of.elements, "grey", [0, 1]);
        truth.setAttribute("aria-label", `true reflectance of ${of.name}`);
        const found = picture === null ? new Float32Array(of.elements[0] * of.elements[1]).fill(NaN) : valuesOf(picture, of);
        const range = /** @type {[number, number]} */ (stretched.checked && picture !== null ? ownRange(found) : [0, 1]);
        paint(recovered, found, of.elements, "grey", range);
        recovered.setAttribute("aria-label", `recovered reflectance of ${of.name}`);
        // What the pointer has read is of another picture now.
        show("element").textContent = "Point at an element to read its value.";
        show("range").textContent = picture === null ? "nothing" : stretched.checked ? `black ${significant(range[0])}, white ${significant(range[1])}` : "black 0, white 1";
    };

    for (const [canvas, name] of /** @type {const} */ ([["picture", "recovered"], ["truth", "truth"]])) {
        show(canvas).addEventListener("pointermove", (event) => {
            const of = slides.surfaces[surface.selectedIndex];
            const [nu, nv] = of.elements;
            const box = show(canvas).getBoundingClientRect();
            const cell = (/** @type {number} */ share, /** @type {number} */ n) => Math.min(n - 1, Math.max(0, Math.floor(share * n)));
            const iu = cell((event.clientX - box.left) / box.width, nu);
            const iv = cell((box.bottom - event.clientY) / box.height, nv);
            const value = (/** @type {number} */ picture) => significant(valuesOf(picture, of)[iu + iv * nu]);
            const picture = element.dataset.picture;
            const found = picture ? `recovered ${value(Number(picture))}, ` : "";
            show("element").textContent = `Element (${iu}, ${iv}): ${found}truth ${value(0)}`;
            show("element").dataset.from = name;
        });
    }
    step.addEventListener("input", () => {
        automatic.checked = false;
        update();
    });
    for (const control of [surface, method, noise, automatic, stretched]) {
        control.addEventListener("input", update);
    }
    update();
    element.hidden = false;
});

/**
 * Numbers of a text as people write them, with three significant digits.
 * @param {string} text
 */
function readable(text) {
    return text.replaceAll(/-?\d+(?:\.\d+)?e[+-]?\d+/g, (number) => significant(Number(number))).replaceAll("σ1", "σ₁");
}

/** @param {number} level */
function noiseWords(level) {
    if (level === 0) {
        return "none: the photographs as traced";
    }
    return `${significant(100 * level, 1)} % of the mean flux`;
}

/**
 * The place of the automatic choice below the slider.
 * @param {HTMLElement} marker
 * @param {number | undefined} at
 * @param {number} count
 */
function markAutomatic(marker, at, count) {
    marker.hidden = at === undefined || count === 1;
    marker.style.setProperty("--share", String((at ?? 0) / Math.max(1, count - 1)));
}

/**
 * From the smallest to the largest number; never of no length.
 * @param {ArrayLike<number>} values
 */
function ownRange(values) {
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < values.length; i++) {
        if (Number.isFinite(values[i])) {
            low = Math.min(low, values[i]);
            high = Math.max(high, values[i]);
        }
    }
    return low < high ? [low, high] : [low - 0.5, low + 0.5];
}

/**
 * MTF and error over the noise, with a line where the picture is.
 * @param {Slides} slides
 * @param {SlideSeries} series
 * @param {(number | undefined)[]} steps which step is taken at each noise
 * @param {number} surface
 * @param {number} level
 */
function slideCurves(slides, series, steps, surface, level) {
    const of = (/** @type {number} */ k) => steps.map((step, n) => (step === undefined ? null : series.measures[n][step]?.[surface]?.[k] ?? null));
    return [
        slideCurve("MTF over noise", slides.noises, level, [0, 1], [
            { name: "normalized", mark: "second", values: of(1) },
            { name: "raw", mark: "first", values: of(0) },
        ]),
        slideCurve("RMSE over noise", slides.noises, level, null, [{ name: "RMSE", mark: "first", values: of(3) }]),
    ];
}

/** Size of a plot, and its margins: left, right, top, bottom. */
const SLIDE_CURVE = { width: 300, height: 170, left: 44, right: 12, top: 26, bottom: 34 };

/**
 * A plot over the noise levels, which stand side by side. Without a range the values are drawn over decades.
 * @param {string} title
 * @param {number[]} noises
 * @param {number} level
 * @param {[number, number] | null} range
 * @param {{ name: string, mark: string, values: (number | null)[] }[]} lines
 */
function slideCurve(title, noises, level, range, lines) {
    const { width, height, left, right, top, bottom } = SLIDE_CURVE;
    const positive = lines.flatMap((l) => l.values).filter((v) => v !== null && v > 0 && Number.isFinite(v)).map((v) => Math.log10(Number(v)));
    const [low, high] = range ?? [Math.floor(Math.min(0, ...positive)), Math.ceil(Math.max(0, ...positive))];
    const span = Math.max(1, high - low);
    const x = (/** @type {number} */ n) => left + ((width - left - right) * n) / Math.max(1, noises.length - 1);
    const y = (/** @type {number} */ v) => top + (height - top - bottom) * (1 - (v - low) / span);
    const place = (/** @type {number} */ v) => (range === null ? Math.log10(v) : v);
    const text = (/** @type {number} */ at, /** @type {number} */ up, /** @type {string} */ anchor, /** @type {string} */ what) =>
        makeSvg("text", { x: at, y: up, "text-anchor": anchor }, what);
    const plot = makeSvg("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", class: "curve", "aria-label": `${title}: ${slideWords(noises, lines)}` });
    const every = Math.ceil(span / 4);
    const ticks = range === null ? Array.from({ length: Math.floor(span / every) + 1 }, (_, i) => low + i * every) : [0, 0.5, 1];
    for (const tick of ticks) {
        const label = range === null ? (tick === 0 ? "1" : tick === 1 ? "10" : `10${raised(tick)}`) : String(tick);
        plot.append(makeSvg("line", { x1: left, x2: width - right, y1: y(tick), y2: y(tick), class: "grid" }), text(left - 6, y(tick) + 4, "end", label));
    }
    noises.forEach((noise, n) => plot.append(text(x(n), height - bottom + 16, "middle", noise === 0 ? "0" : `10${raised(Math.round(Math.log10(noise)))}`)));
    plot.append(text((left + width - right) / 2, height - 3, "middle", "noise added, share of the mean"), makeSvg("line", { x1: x(level), x2: x(level), y1: top, y2: height - bottom, class: "now" }));
    lines.forEach((line, i) => {
        plot.append(makeSvg("g", { class: `line ${line.mark}` }, ...slidePoints(line.values, x, (v) => (v > 0 || range !== null ? place(v) : NaN), y, [low, high])));
        plot.append(makeSvg("g", { class: `line ${line.mark}` }, makeSvg("path", { d: `M${left + 130 * i},10h22` }), text(left + 28 + 130 * i, 14, "start", lines.length === 1 ? line.name : `MTF ${line.name}`)));
    });
    return make("figure", { class: "plot" }, plot);
}

/**
 * The points of a line and what joins them; a value beyond the range is an arrow at its edge.
 * @param {(number | null)[]} values
 * @param {(n: number) => number} x
 * @param {(v: number) => number} place
 * @param {(v: number) => number} y
 * @param {[number, number]} range
 */
function slidePoints(values, x, place, y, [low, high]) {
    /** @type {SVGElement[]} */
    const marks = [];
    let path = "";
    values.forEach((value, n) => {
        const at = value === null ? NaN : place(value);
        if (Number.isNaN(at)) {
            path += " ";
            return;
        }
        const title = makeSvg("title", {}, significant(value));
        const inside = at >= low && at <= high;
        const [cx, cy] = [x(n), y(Math.min(high, Math.max(low, at)))];
        const up = at > high ? 1 : -1;
        marks.push(inside ? makeSvg("circle", { cx, cy, r: 3.5 }, title) : makeSvg("path", { d: `M${cx - 5},${cy + 4 * up}h10l-5,${-9 * up}z`, class: "beyond" }, title));
        path += `${path === "" || path.endsWith(" ") ? "M" : "L"}${cx},${cy}`;
    });
    return [makeSvg("path", { d: path.trim() || "M0,0" }), ...marks];
}

/**
 * A plot in words, for those who do not see it.
 * @param {number[]} noises
 * @param {{ name: string, values: (number | null)[] }[]} lines
 */
function slideWords(noises, lines) {
    return lines.map((l) => `${l.name} ${l.values.map((v, n) => `${significant(v, 2)} at noise ${significant(noises[n], 1)}`).join(", ")}`).join("; ");
}
