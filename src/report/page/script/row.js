// A pixel's row of Φcam: traced with its error bars and modelled, or residual and z, over all spots.

/**
 * @param {Circumstances} about
 * @param {Source} source
 */
function rowPlot(about, source) {
    const model = about.model && source.has("modelled");
    const what = make("select", {});
    const kinds = model ? ["flux", "residual", "z"].filter((kind) => kind !== "z" || source.has("z")) : ["flux"];
    const names = { flux: model ? "traced and modelled flux" : "traced flux", residual: "traced − modelled", z: "z" };
    what.append(...kinds.map((k) => make("option", { value: k }, names[/** @type {keyof typeof names} */ (k)])));
    const legend = make("div");
    const panels = make("div", { class: "panels one" });
    const element = make(
        "div",
        { class: "row-of-pixel" },
        make("div", { class: "controls" }, make("label", {}, "The pixel over all spots", what)),
        make("figure", { class: "plot upgraded" }, make("div", { class: "live" }, legend, panels)),
    );
    /** @type {DrawnPlot | undefined} */
    let plot;
    let [drawn, shownKind] = ["", ""];

    /**
     * The series of a kind.
     * @param {number} pixel
     * @returns {Promise<{ title: string, series: PlotSeries[] }>}
     */
    const found = async (pixel) => {
        const x = source.spots;
        const ask = (/** @type {MatrixName} */ name) => (source.has(name) ? source.row(name, pixel) : undefined);
        const [traced, modelled, stderr, z] = await Promise.all([ask("traced"), ask("modelled"), ask("stderr"), ask("z")]);
        const none = Float64Array.from(x, () => NaN);
        const series = (/** @type {string} */ name, /** @type {number} */ look, /** @type {ArrayLike<number>} */ y) => ({ name, look, points: { x, y } });
        const banded = (/** @type {string} */ name, /** @type {ArrayLike<number>} */ y) => ({
            ...series(name, 0, y),
            ...(stderr === undefined ? {} : { low: Float64Array.from(y, (v, i) => v - stderr[i]), high: Float64Array.from(y, (v, i) => v + stderr[i]) }),
        });
        const zero = Float64Array.from(x, () => 0);
        if (what.value === "z") {
            const limit = about.limit;
            const lines = limit === null ? [] : [series("limit for the largest |z|", 5, zero.map(() => limit)), series("", 5, zero.map(() => -limit))];
            return { title: "z / standard errors", series: [series("z", 0, z ?? none), ...lines] };
        }
        if (what.value === "residual" && traced !== undefined && modelled !== undefined) {
            const residual = Float64Array.from(traced, (t, i) => t - modelled[i]);
            return { title: "traced − modelled / W", series: [banded("traced − modelled ± standard error", residual), series("0", 5, zero)] };
        }
        const second = modelled === undefined ? [] : [series("modelled", 1, modelled)];
        return { title: "flux into the pixel / W", series: [banded("traced ± standard error", traced ?? none), ...second] };
    };

    const show = async () => {
        const { pixel } = chosen;
        const kind = what.value;
        const wanted = `${kind} ${pixel}`;
        if (wanted !== drawn) {
            const { title, series } = await found(pixel);
            if (wanted !== `${what.value} ${chosen.pixel}`) {
                return;
            }
            drawn = wanted;
            if (plot === undefined || shownKind !== kind) {
                shownKind = kind;
                const panel = make("div", { class: "panel" });
                panels.replaceChildren(panel);
                const fresh = drawPlot(panel, {
                    title: `${title}, of the chosen pixel`,
                    x: { title: "spot", run: "linear" },
                    y: { title, run: "linear" },
                    series,
                    height: 260,
                    onPick: (spot) => choose({ spot }),
                });
                plot = fresh;
                panel.append(toolsOf(fresh, "row", { ...fresh.spec }));
                legend.replaceChildren(
                    legendOf([fresh.spec], (key, hidden) => fresh.update({ series: fresh.spec.series.map((s) => (keyOf(s) === key ? { ...s, hidden } : s)) })),
                );
            } else {
                const hidden = new Set(plot.spec.series.filter((s) => s.hidden).map(keyOf));
                plot.update({ series: series.map((s) => ({ ...s, hidden: hidden.has(keyOf(s)) })) });
            }
        }
        plot?.update({ marked: [chosen.spot] });
    };
    what.addEventListener("change", show);
    return { element, show };
}
