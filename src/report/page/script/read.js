// Reads values off a plot: the nearest point under the pointer, or point by point with the arrow keys.

const KEYS = "Left and right arrow: point by point. Up and down arrow: next series. Escape: none.";

/**
 * @param {HTMLElement} picture what holds the plot
 * @param {HTMLElement} said where values are said
 * @param {() => ReturnType<typeof plotElement>} drawn
 * @param {PlotSpec} spec
 */
function readPlot(picture, said, drawn, spec) {
    const tip = make("div", { class: "tip", "aria-hidden": "true", hidden: true });
    picture.append(tip);
    const more = spec.onPick ? " Enter: choose." : "";
    const about = `${spec.title || spec.y.title}. ${KEYS}${more}`;
    for (const [name, value] of Object.entries({ tabindex: "0", role: "application", "aria-roledescription": "plot", "aria-label": about })) {
        picture.setAttribute(name, value);
    }
    /** @type {{ series: PlotSeries, index: number } | undefined} */
    let picked;
    /** The points of the plot as drawn, by growing place across. @type {{ series: PlotSeries, rows: number[], x: number[], y: number[] }[] | undefined} */
    let placed;

    const places = () => {
        const { place, inside } = drawn();
        placed ??= spec.series.filter((s) => s.hidden !== true).map((series) => {
            const { xs, ys } = columns(series);
            const rows = Array.from({ length: xs.length }, (_, i) => i).filter((i) => inside(xs[i], ys[i])).sort((a, b) => xs[a] - xs[b] || a - b);
            return { series, rows, x: rows.map((i) => place.x(xs[i])), y: rows.map((i) => place.y(ys[i])) };
        }).filter((s) => s.rows.length > 0);
        return placed;
    };

    const show = () => {
        drawn().svg.querySelector(".picked")?.remove();
        const of = picked && places().find((s) => s.series === picked?.series);
        const k = of === undefined ? -1 : of.rows.indexOf(picked?.index ?? -1);
        tip.hidden = of === undefined || k < 0;
        if (picked === undefined || of === undefined || k < 0) {
            return;
        }
        const { svg, width, up } = drawn();
        const [x, y] = [of.x[k], of.y[k]];
        svg.append(makeSvg("g", { class: "picked", "pointer-events": "none" },
            makeSvg("path", { d: `M${x} ${up[0]}V${up[1]}`, stroke: "#222222", "stroke-width": 0.6 }),
            makeSvg("circle", { cx: x, cy: y, r: 7, fill: "none", stroke: "#222222", "stroke-width": 2 })));
        const { series, index } = picked;
        const { xs, ys } = columns(series);
        const band = series.low && series.high ? ` (${valueText(series.low[index])} to ${valueText(series.high[index])})` : "";
        const across = `${spec.x.title}: ${valueText(xs[index])}`;
        const upwards = `${spec.y.title}: ${valueText(ys[index])}${band}`;
        const name = legendText(series);
        tip.replaceChildren(...(name === "" ? [] : [make("b", {}, name)]), make("span", {}, across), make("span", {}, upwards));
        said.textContent = [name, across, upwards].filter((words) => words !== "").join("; ");
        const share = svg.getBoundingClientRect().width / width || 1;
        tip.style.top = `${Math.max(0, share * y - 12)}px`;
        tip.style.left = x < width / 2 ? `${share * x + 14}px` : "auto";
        tip.style.right = x < width / 2 ? "auto" : `${share * (width - x) + 14}px`;
    };

    const none = () => {
        picked = undefined;
        said.textContent = "";
        show();
    };

    /** The point that is nearest to where the pointer is. */
    const nearest = (/** @type {PointerEvent | MouseEvent} */ event) => {
        const { svg, width } = drawn();
        const box = svg.getBoundingClientRect();
        const share = width / (box.width || width);
        const [x, y] = [share * (event.clientX - box.left), share * (event.clientY - box.top)];
        let least = Infinity;
        /** @type {typeof picked} */
        let found;
        for (const of of places()) {
            for (let k = 0; k < of.rows.length; k++) {
                const away = (of.x[k] - x) ** 2 + (of.y[k] - y) ** 2;
                if (away < least) {
                    least = away;
                    found = { series: of.series, index: of.rows[k] };
                }
            }
        }
        return found;
    };

    const point = (/** @type {PointerEvent} */ event) => {
        picked = nearest(event);
        show();
    };
    picture.addEventListener("pointermove", point);
    picture.addEventListener("pointerdown", point);
    picture.addEventListener("pointerleave", (event) => {
        // A finger that is lifted leaves what it has shown.
        if (event.pointerType === "mouse" && document.activeElement !== picture) {
            none();
        }
    });
    picture.addEventListener("click", (event) => {
        picked = nearest(event);
        choosePicked();
    });
    picture.addEventListener("blur", none);

    const choosePicked = () => {
        if (picked !== undefined) {
            spec.onPick?.(columns(picked.series).xs[picked.index], picked.series);
        }
    };

    /** The key's step from the picked point, or to the first. */
    const walk = (/** @type {string} */ key) => {
        const all = places();
        if (all.length === 0) {
            return;
        }
        const s = all.findIndex((of) => of.series === picked?.series);
        const k = s < 0 ? -1 : all[s].rows.indexOf(picked?.index ?? -1);
        if (s < 0 || k < 0) {
            picked = { series: all[0].series, index: all[0].rows[0] };
            return;
        }
        const { rows, x } = all[s];
        if (key === "ArrowUp" || key === "ArrowDown") {
            const next = all[(s + (key === "ArrowDown" ? 1 : all.length - 1)) % all.length];
            const away = next.x.map((at) => Math.abs(at - x[k]));
            picked = { series: next.series, index: next.rows[away.indexOf(Math.min(...away))] };
            return;
        }
        const to = { ArrowLeft: k - 1, ArrowRight: k + 1, Home: 0, End: rows.length - 1 }[key] ?? k;
        picked = { series: all[s].series, index: rows[Math.min(rows.length - 1, Math.max(0, to))] };
    };

    picture.addEventListener("keydown", (event) => {
        if (["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End"].includes(event.key)) {
            event.preventDefault();
            walk(event.key);
            show();
        } else if (event.key === "Escape") {
            none();
        } else if (spec.onPick !== undefined && (event.key === "Enter" || event.key === " ")) {
            event.preventDefault();
            choosePicked();
        }
    });

    return {
        /** After it was drawn again. */
        again() {
            placed = undefined;
            show();
        },
    };
}
