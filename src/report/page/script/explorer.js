// The explorer of Φcam: a spot's frame and a pixel's row, traced, modelled, residual, z, and which error bars are not to be trusted.

/** More pixels a side than this are not drawn at once. */
const MOST_SHOWN = 512;

upgrade(".explorer", async (root) => {
    const about = /** @type {Circumstances} */ ({ ...data("explorer-data"), places: data("explorer-places") });
    const source = (await served(about)) ?? (await embedded(about));
    if (source.spots.length === 0) {
        root.append(make("p", { class: "note" }, "The matrices are not in this page: ", make("code", {}, "phicam serve DIR"), " shows them."));
        return;
    }

    /**
     * What is shown of each frame, in pixels of the camera.
     * @type {Box}
     */
    const whole = { x: 0, y: 0, w: about.columns, h: about.rows, step: stepFor(about.columns, about.rows, source.every) };
    let box = whole;

    const snapped = (/** @type {number} */ x, /** @type {number} */ y) => {
        const inside = (/** @type {number} */ i, /** @type {number} */ n) => middle(Math.min(n - 1, Math.max(0, i)), source.every, n);
        return inside(x, about.columns) + inside(y, about.rows) * about.columns;
    };
    const pickPixel = (/** @type {number} */ x, /** @type {number} */ y) => choose({ pixel: snapped(x, y) });
    const pickShare = (/** @type {number} */ x, /** @type {number} */ y) => {
        const [columns, rows] = extent(box);
        const inside = (/** @type {number} */ cell, /** @type {number} */ from, /** @type {number} */ length) =>
            Math.min(from + length - 1, from + cell * box.step + Math.floor((box.step - 1) / 2));
        pickPixel(inside(Math.floor(x * columns), box.x, box.w), inside(Math.floor(y * rows), box.y, box.h));
    };
    limitChoice(({ spot, pixel }) => ({
        spot: source.spots.reduce((a, b) => (Math.abs(b - spot) < Math.abs(a - spot) ? b : a)),
        pixel: snapped(pixel % about.columns, Math.floor(pixel / about.columns)),
    }));

    const layers = about.model
        ? [
              { title: "traced", unit: "W", map: /** @type {MapName} */ ("viridis"), explanation: "flux into each pixel as the path tracer found it, without knowing the model" },
              { title: "modelled", unit: "W", map: /** @type {MapName} */ ("viridis"), explanation: "flux into each pixel by the matrix model" },
              { title: "residual", unit: "W", map: /** @type {MapName} */ ("diverging"), explanation: "traced minus modelled" },
              { title: "z", unit: "standard errors", map: /** @type {MapName} */ ("diverging"), explanation: "residual beyond the model's stated bound in units of its standard error, as a standard normal deviate" },
          ]
        : [
              { title: "traced", unit: "W", map: /** @type {MapName} */ ("viridis"), explanation: "flux into each pixel as the path tracer found it" },
              { title: "standard error", unit: "W", map: /** @type {MapName} */ ("viridis"), explanation: "what chance alone makes the traced flux deviate by" },
          ];
    if (source.has("tails")) {
        const words = about.tails.map(([bit, what]) => `${bit}: ${what}`).join("; ");
        layers.push({ title: "doubt", unit: "code", map: /** @type {MapName} */ ("viridis"), explanation: `where the standard error is not to be trusted; 0: it is; ${words}; codes add up` });
    }
    const panels = layers.map((layer) => framePanel(layer, pickShare));

    const last = source.spots.length - 1;
    const spotRange = make("input", { type: "range", min: 0, max: last, step: 1, id: "explorer-spot" });
    const columnRange = make("input", { type: "range", min: 0, max: about.columns - 1, step: source.every, id: "explorer-column" });
    const rowRange = make("input", { type: "range", min: 0, max: about.rows - 1, step: source.every, id: "explorer-row" });
    const said = [make("output"), make("output"), make("output")];
    const labelled = (/** @type {string} */ text, /** @type {HTMLInputElement} */ input, /** @type {HTMLElement} */ output) =>
        make("label", { class: "slider" }, make("span", {}, text, output), input);
    const span = make("select", {}, make("option", { value: "all" }, "all spots"), make("option", { value: "one" }, "this spot"));
    const shared = make("input", { type: "checkbox" });
    const zoom = [
        make("button", { type: "button", click: () => resize(0.5) }, "Zoom in"),
        make("button", { type: "button", click: () => resize(2) }, "Zoom out"),
    ];
    const readout = make("tbody");
    const table = make("table", { class: "readout" }, make("caption", {}, "The chosen entry"), readout);
    const drawing = plan(about, source, pickPixel);
    const row = rowPlot(about, source);

    const controls = make(
        "div",
        { class: "explorer-controls" },
        labelled("Spot ", spotRange, said[0]),
        labelled("Pixel column ", columnRange, said[1]),
        labelled("Pixel row ", rowRange, said[2]),
        make(
            "div",
            { class: "controls" },
            make("label", {}, "Colours span", span),
            ...(about.model ? [make("label", { class: "tick" }, shared, "one scale for traced, modelled and residual")] : []),
            ...zoom,
        ),
        make("div", { "aria-live": "polite" }, table),
    );
    const [stepped, thinned] = [source.every > 1, source.spots.length < about.spots];
    const left = [thinned ? `one spot of every ${about.step}` : "", stepped ? `the middle pixel of every ${source.every} × ${source.every}` : ""].filter((t) => t);
    root.replaceChildren(
        make("p", {}, "Choose a spot to see its photograph, and a pixel to see its row of the matrix. Sliders move by arrow keys; spots and pixels can be clicked."),
        ...(left.length > 0
            ? [make("p", { class: "note" }, `The whole matrix is too large for a page: here are ${left.join(" and ")}, unchanged. `, make("code", {}, "phicam serve DIR"), " shows every entry.")]
            : []),
        ...(about.bits !== null && !source.served
            ? [make("p", { class: "note" }, rounding(about.bits))]
            : []),
        make("div", { class: "explorer-top" }, drawing.element, controls),
        make("div", { class: "frames" }, ...panels.map((p) => p.element)),
        row.element,
    );

    /** @param {number} factor */
    function resize(factor) {
        const size = (/** @type {number} */ now, /** @type {number} */ n) => Math.min(n, Math.max(Math.min(n, 8), Math.round(now * factor)));
        const [w, h] = [size(box.w, about.columns), size(box.h, about.rows)];
        const start = (/** @type {number} */ at, /** @type {number} */ width, /** @type {number} */ n) => Math.min(n - width, Math.max(0, at - Math.floor(width / 2)));
        const [x, y] = [start(chosen.pixel % about.columns, w, about.columns), start(Math.floor(chosen.pixel / about.columns), h, about.rows)];
        const step = stepFor(w, h, source.every);
        box = w === about.columns && h === about.rows ? whole : { x: x - (x % step), y: y - (y % step), w, h, step };
        later();
    }

    /** Values of every layer of a spot. */
    async function values(/** @type {number} */ spot, /** @type {Box} */ part) {
        const get = (/** @type {MatrixName} */ name) => (source.has(name) ? source.frame(name, spot, part) : new Float64Array(extent(part)[0] * extent(part)[1]).fill(NaN));
        const tails = source.has("tails") ? [await get("tails")] : [];
        if (!about.model) {
            return [...(await Promise.all([get("traced"), get("stderr")])), ...tails];
        }
        const [traced, modelled, z] = await Promise.all([get("traced"), get("modelled"), get("z")]);
        return [traced, modelled, Float64Array.from(traced, (x, i) => x - modelled[i]), z, ...tails];
    }

    /** @returns {[number, number][]} */
    function ranges(/** @type {ArrayLike<number>[]} */ found) {
        const all = span.value === "all";
        /** @type {[number, number]} */
        const codes = [0, about.tails.reduce((sum, [bit]) => sum + bit, 0)];
        if (!about.model) {
            return [all ? (about.range ?? rangeOf([found[0]])) : rangeOf([found[0]]), all && about.stderr !== null ? [0, about.stderr || 1] : rangeOf([found[1]]), codes];
        }
        const flux = (all && about.range) || rangeOf(found.slice(0, 2));
        const largest = Math.max(...rangeOf([found[2]]).map(Math.abs));
        const residual = shared.checked ? around(Math.max(...flux.map(Math.abs))) : around(all ? (about.residual ?? largest) : largest);
        return [flux, flux, residual, around(about.limit ?? 4), codes];
    }

    let turn = 0;
    async function show() {
        const mine = ++turn;
        const [{ spot, pixel }, part] = [{ ...chosen }, box];
        const found = await values(spot, part);
        // Meanwhile something else was asked for.
        if (mine !== turn) {
            return;
        }
        const limits = ranges(found);
        const size = extent(part);
        const [column, line] = [pixel % about.columns, Math.floor(pixel / about.columns)];
        /** @type {[number, number]} */
        const at = [(Math.floor((column - part.x) / part.step) + 0.5) / size[0], (Math.floor((line - part.y) / part.step) + 0.5) / size[1]];
        /** @type {[number, number]} */
        const each = [1 / size[0], 1 / size[1]];
        const aspect = (lengthOf(about.view.u) * size[0] * about.rows) / (lengthOf(about.view.v) * size[1] * about.columns);
        panels.forEach((panel, i) => panel.show(found[i], size, limits[i], at, each, aspect));
        const k = source.spots.indexOf(spot);
        spotRange.value = String(k);
        columnRange.value = String(column);
        rowRange.value = String(line);
        said[0].textContent = `${spot} of ${about.spots} at ${place(about, spot)}`;
        said[1].textContent = `${column}`;
        said[2].textContent = `${line}`;
        spotRange.setAttribute("aria-valuetext", `spot ${said[0].textContent}`);
        drawing.show(chosen);
        await tell(spot, pixel);
        await row.show();
    }

    /** The chosen entry in numbers. */
    async function tell(/** @type {number} */ spot, /** @type {number} */ pixel) {
        const one = { x: pixel % about.columns, y: Math.floor(pixel / about.columns), w: 1, h: 1, step: 1 };
        const entry = async (/** @type {MatrixName} */ name) => (source.has(name) ? (await source.frame(name, spot, one))[0] : NaN);
        const [traced, stderr, modelled, z, code] = await Promise.all([entry("traced"), entry("stderr"), entry("modelled"), entry("z"), entry("tails")]);
        if (spot !== chosen.spot || pixel !== chosen.pixel) {
            return;
        }
        const line = (/** @type {string} */ name, /** @type {number} */ value, /** @type {string} */ unit) =>
            make("tr", {}, make("th", { scope: "row" }, name), make("td", { class: "n" }, make("data", { value, "data-of": name }, significant(value)), ` ${unit}`));
        const nought = z !== 0 || traced === modelled ? "" : code > 0 ? ": not counted, as its standard error is in doubt" : code !== 0 ? "" : ": no more than the model's stated bound, which is taken off first";
        const doubts = about.tails.filter(([bit]) => (code & bit) !== 0).map(([, what]) => what);
        readout.replaceChildren(
            line("traced", traced, "W"),
            line("standard error", stderr, "W"),
            ...(source.has("tails") ? [line("doubt", code, doubts.join(", ") || "none: the standard error can be trusted")] : []),
            ...(about.model ? [line("modelled", modelled, "W"), line("residual", traced - modelled, "W"), line("z", z, `standard errors${nought}`)] : []),
        );
        readout.dataset.spot = String(spot);
        readout.dataset.pixel = String(pixel);
    }

    const failed = make("p", { class: "note", role: "status" });
    root.append(failed);
    if (about.range === null) {
        // The ends of all spots' values are not known.
        span.value = "one";
        span.disabled = true;
    }
    let waiting = false;
    /** Shows what is chosen at the next frame of the screen, once. */
    function later() {
        if (!waiting) {
            waiting = true;
            requestAnimationFrame(() => {
                waiting = false;
                show().then(
                    () => (failed.textContent = ""),
                    (error) => (failed.textContent = String(error)),
                );
            });
        }
    }

    spotRange.addEventListener("input", () => choose({ spot: source.spots[Number(spotRange.value)] }));
    const moved = () => pickPixel(Number(columnRange.value), Number(rowRange.value));
    columnRange.addEventListener("input", moved);
    rowRange.addEventListener("input", moved);
    span.addEventListener("change", later);
    shared.addEventListener("change", later);
    onChoice(later);
    choose({ spot: source.spots[Math.floor(source.spots.length / 2)], pixel: snapped(Math.floor(about.columns / 2), Math.floor(about.rows / 2)) });
    await show();
});

/**
 * How exact the numbers in the page are, in words: of fluxes, standard errors and z so many bits are kept.
 * @param {[number, number, number]} bits
 */
function rounding([flux, error, z]) {
    const share = (/** @type {number} */ bits) => significant(2 ** -bits, 1);
    return `So that the page stays small, its fluxes are rounded by at most ${share(flux)} of their value (a residual, the difference of two, by twice that share of the flux), standard errors by ${share(error)}, z by ${share(z)}. phi.npy has every digit.`;
}

/** @param {number[]} v */
function lengthOf(v) {
    return Math.hypot(...v);
}

/**
 * The step at which so many pixels can be drawn: a multiple of what there is.
 * @param {number} w
 * @param {number} h
 * @param {number} every
 */
function stepFor(w, h, every) {
    return every * Math.max(1, Math.ceil(Math.max(w, h) / (MOST_SHOWN * every)));
}
