// The figures of studies: what their panels say of themselves (plotted.rs) becomes plots that answer, below one legend.

upgrade("figure.plot", (figure) => {
    const drawing = /** @type {SVGSVGElement | null} */ (figure.querySelector("svg"));
    if (drawing === null) {
        return;
    }
    const name = figure.dataset.name ?? "figure";
    /** @type {PlotSpec[]} */
    const specs = Array.from(drawing.querySelectorAll("metadata"), (told) => JSON.parse(told.textContent ?? ""));
    if (specs.length === 0) {
        const markup = () => new XMLSerializer().serializeToString(drawing);
        figure.append(make("div", { class: "tools" }, make("button", { type: "button", "aria-label": `SVG of ${name}`, click: () => save(`${name}.svg`, "image/svg+xml", markup()) }, "SVG")));
        return;
    }
    // A sheet that has room for one title of its own lends it to its only panel.
    const title = drawing.getAttribute("aria-label") ?? name;
    const live = make("div", { class: "live" }, make("p", { class: "title" }, title));
    const note = Array.from(drawing.querySelectorAll("text.remark"), (line) => line.textContent).join(" ");
    if (note) {
        live.append(make("p", { class: "note" }, note));
    }
    const plots = make("div", { class: specs.length === 1 ? "panels one" : [2, 4].includes(specs.length) ? "panels two" : "panels" });
    /** @type {DrawnPlot[]} */
    const drawn = [];
    live.append(legendOf(specs, (key, hidden) => {
        for (const plot of drawn) {
            plot.update({ series: plot.spec.series.map((s) => (keyOf(s) === key ? { ...s, hidden } : s)) });
        }
    }), plots);
    // Before the plots, so that these know their widths.
    figure.append(live);
    specs.forEach((spec, i) => {
        const heading = spec.title || (specs.length === 1 ? title : `${spec.y.title} against ${spec.x.title}`);
        const panel = make("div", { class: "panel" });
        if (specs.length > 1) {
            panel.append(make("p", { class: "heading" }, heading));
        }
        plots.append(panel);
        const plot = drawPlot(panel, { ...spec, title: heading });
        drawn.push(plot);
        panel.append(toolsOf(plot, specs.length === 1 ? name : `${name}-${i + 1}`, spec));
    });
    figure.classList.add("upgraded");
});

/**
 * What tells series of several panels apart.
 * @param {PlotSeries} series
 */
function keyOf(series) {
    return JSON.stringify([series.kind, series.look, series.name]);
}

/**
 * A button for each series that has a name.
 * @param {PlotSpec[]} specs
 * @param {(key: string, hidden: boolean) => void} toggle
 */
function legendOf(specs, toggle) {
    const legend = make("div", { class: "legend", role: "group", "aria-label": "Series, shown or hidden" });
    /** @type {Map<string, PlotSeries>} */
    const all = new Map();
    for (const series of specs.flatMap((spec) => spec.series)) {
        if (series.name !== "" && !all.has(keyOf(series))) {
            all.set(keyOf(series), series);
        }
    }
    for (const [key, series] of all) {
        const sample = makeSvg("svg", { width: 34, height: 16, viewBox: "0 0 34 16", "aria-hidden": "true" });
        sample.append(sampleOf(series));
        const button = make("button", {
            type: "button",
            "aria-pressed": "true",
            click: () => {
                const hidden = button.getAttribute("aria-pressed") === "true";
                button.setAttribute("aria-pressed", String(!hidden));
                toggle(key, hidden);
            },
        });
        button.append(sample, make("span", {}, legendText(series)));
        legend.append(button);
    }
    return legend;
}

/**
 * Boxes for logarithmic axes, and what is shown as files.
 * @param {DrawnPlot} plot
 * @param {string} name
 * @param {PlotSpec} first how it was to begin with
 */
function toolsOf(plot, name, first) {
    const title = plot.spec.title ?? name;
    const box = (/** @type {"x" | "y"} */ side) => {
        const values = plot.spec.series.flatMap((s) => Array.from(side === "x" ? columns(s).xs : columns(s).ys)).filter(Number.isFinite);
        const allowed = first[side].run === "logarithmic" || (values.length > 0 && values.every((v) => v > 0));
        const input = make("input", {
            type: "checkbox",
            disabled: !allowed,
            "aria-label": `log ${side}: ${title}`,
            change: () => {
                const run = input.checked ? "logarithmic" : "linear";
                const ends = run === first[side].run ? first[side].ends : undefined;
                plot.update({ [side]: { ...plot.spec[side], run, ends } });
            },
        });
        input.checked = first[side].run === "logarithmic";
        return make("label", allowed ? {} : { title: "some values are not positive", class: "off" }, input, `log ${side}`);
    };
    const button = (/** @type {string} */ kind, /** @type {() => void} */ click) => make("button", { type: "button", "aria-label": `${kind} of ${title}`, click }, kind);
    return make("div", { class: "tools" }, box("x"), box("y"),
        button("SVG", () => save(`${name}.svg`, "image/svg+xml", plotSvg(plot.svg(), plot.spec))),
        button("CSV", () => save(`${name}.csv`, "text/csv", plotCsv(plot.spec))));
}
