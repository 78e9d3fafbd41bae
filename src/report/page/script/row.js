// A pixel's row of Φcam: traced with its error bars and modelled, or residual and z, over all spots.

/**
 * @param {Circumstances} about
 * @param {Source} source
 */
function rowPlot(about, source) {
    const what = make("select", { "aria-label": "What the curves show" });
    const kinds = about.model ? ["flux", "residual", "z"] : ["flux"];
    const names = { flux: "traced and modelled flux", residual: "traced − modelled", z: "z" };
    what.append(...kinds.map((k) => make("option", { value: k }, names[/** @type {keyof typeof names} */ (k)])));
    const place = make("div", { class: "plot-card" });
    const said = make("p", { class: "note" });
    const element = make(
        "div",
        { class: "row-of-pixel" },
        make("div", { class: "controls" }, make("label", {}, "The pixel over all spots", what)),
        place,
        said,
    );
    /** @type {{ pixel: number, kind: string, width: number } | undefined} */
    let drawn;
    /** @type {SVGLineElement | undefined} */
    let marker;
    /** @type {((spot: number) => number) | undefined} */
    let along;

    const draw = async (/** @type {number} */ pixel) => {
        const kind = what.value;
        const width = Math.max(280, Math.min(1100, place.clientWidth - 16));
        if (drawn?.pixel === pixel && drawn.kind === kind && drawn.width === width) {
            return;
        }
        const ask = (/** @type {MatrixName} */ name) => (source.has(name) ? source.row(name, pixel) : undefined);
        const [traced, modelled, stderr, z] = await Promise.all([ask("traced"), ask("modelled"), ask("stderr"), ask("z")]);
        if (pixel !== chosen.pixel || traced === undefined) {
            return;
        }
        drawn = { pixel, kind, width };
        const spots = source.spots;
        const marks = [];
        const line = (/** @type {ArrayLike<number>} */ values, /** @type {string} */ ink, /** @type {string} */ dash) =>
            Plot.line(spots, { x: (_, i) => spots[i], y: (_, i) => values[i], stroke: ink, strokeWidth: 1.6, strokeDasharray: dash });
        const band = (/** @type {(i: number) => number} */ centre) =>
            Plot.areaY(spots, {
                x: (_, i) => spots[i],
                y1: (_, i) => centre(i) - /** @type {any} */ (stderr)[i],
                y2: (_, i) => centre(i) + /** @type {any} */ (stderr)[i],
                fill: "#0072b2",
                fillOpacity: 0.25,
            });
        let [label, words] = ["", ""];
        if (kind === "flux") {
            label = "flux into the pixel / W";
            words = "Blue: traced, with its standard error as a band. Vermillion, dashed: modelled.";
            if (stderr !== undefined) {
                marks.push(band((i) => traced[i]));
            }
            marks.push(line(traced, "#0072b2", ""));
            if (modelled !== undefined) {
                marks.push(line(modelled, "#d55e00", "8 3"));
            }
        } else if (kind === "residual" && modelled !== undefined) {
            const residual = Float64Array.from(traced, (x, i) => x - modelled[i]);
            label = "traced − modelled / W";
            words = "Blue: difference, with the standard error of the traced flux as a band.";
            marks.push(Plot.ruleY([0]));
            if (stderr !== undefined) {
                marks.push(band((i) => residual[i]));
            }
            marks.push(line(residual, "#0072b2", ""));
        } else if (z !== undefined) {
            label = "z / standard errors";
            words = "Blue: z. Dashed: the limit for the largest |z| of all entries.";
            marks.push(Plot.ruleY([0]), line(z, "#0072b2", ""));
            if (about.limit !== null) {
                marks.push(Plot.ruleY([-about.limit, about.limit], { strokeDasharray: "4 4" }));
            }
        }
        const plot = /** @type {SVGSVGElement & { scale: (name: "x") => { apply: (x: number) => number } }} */ (
            /** @type {unknown} */ (
                Plot.plot({
                    width,
                    height: 230,
                    marginLeft: 76,
                    marginTop: 30,
                    marginBottom: 40,
                    ariaLabel: `${names[/** @type {keyof typeof names} */ (kind)]} of the chosen pixel over all spots`,
                    style: { background: "transparent", color: "#222222", fontSize: "12px", fontFamily: "inherit" },
                    x: { label: "spot", labelAnchor: "center", labelArrow: "none", grid: true, domain: [spots[0], spots[spots.length - 1] || 1] },
                    y: { label, labelAnchor: "top", labelArrow: "none", grid: true, ticks: 5, tickFormat: (/** @type {number} */ y) => significant(y, 2) },
                    marks: [Plot.frame(), ...marks],
                })
            )
        );
        along = plot.scale("x").apply;
        // The picture has one name; its parts have no role that could bear one.
        plot.setAttribute("role", "img");
        plot.querySelectorAll("[aria-label]").forEach((part) => part.removeAttribute("aria-label"));
        marker = makeSvg("line", { y1: 30, y2: 190, stroke: "#222222", "stroke-width": 1.4, "stroke-dasharray": "2 2" });
        plot.append(marker);
        plot.addEventListener("click", (event) => {
            const box = plot.getBoundingClientRect();
            const x = ((event.clientX - box.left) * width) / box.width;
            const apply = /** @type {(spot: number) => number} */ (along);
            const nearest = spots.reduce((a, b) => (Math.abs(apply(b) - x) < Math.abs(apply(a) - x) ? b : a));
            choose({ spot: nearest });
        });
        place.replaceChildren(plot);
        said.textContent = `${words} A click chooses the spot.`;
    };
    const mark = () => {
        if (marker !== undefined && along !== undefined) {
            const x = String(along(chosen.spot));
            marker.setAttribute("x1", x);
            marker.setAttribute("x2", x);
        }
    };
    const show = async () => {
        await draw(chosen.pixel);
        mark();
    };
    what.addEventListener("change", show);
    new ResizeObserver(show).observe(place);
    return { element, show };
}
