// What is shown, as files.

/**
 * Saves text as a file.
 * @param {string} name
 * @param {string} type
 * @param {string} text
 */
function save(name, type, text) {
    const address = URL.createObjectURL(new Blob([text], { type }));
    const link = make("a", { href: address, download: name });
    document.body.append(link);
    link.click();
    link.remove();
    // The browser reads it after this returns.
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/**
 * A field of comma-separated values.
 * @param {string} text
 */
function field(text) {
    return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/**
 * All series of a plot, shown or not, with full digits: a line a point.
 * @param {PlotSpec} spec
 */
function plotCsv(spec) {
    const bands = spec.series.some((s) => s.low !== undefined);
    const number = (/** @type {number | null | undefined} */ x) => (x === null || x === undefined || Number.isNaN(x) ? "" : String(x));
    const head = ["series", "source", spec.x.title, spec.y.title, ...(bands ? ["low", "high"] : [])];
    const lines = [head.map(field).join(",")];
    for (const series of spec.series) {
        const { xs, ys } = columns(series);
        const named = [series.name, series.kind === "published" ? "published" : "computed"].map(field);
        for (let i = 0; i < xs.length; i++) {
            const band = bands ? [number(series.low?.[i]), number(series.high?.[i])] : [];
            lines.push([...named, number(xs[i]), number(ys[i]), ...band].join(","));
        }
    }
    return `${lines.join("\n")}\n`;
}

const FAMILIES = "DejaVu Sans, Verdana, sans-serif";

/**
 * A plot as it is shown, with its title and the legend of what is in it, as an SVG of its own.
 * @param {SVGSVGElement} drawn
 * @param {PlotSpec} spec
 */
function plotSvg(drawn, spec) {
    const width = Number(drawn.getAttribute("width"));
    const height = Number(drawn.getAttribute("height"));
    const shown = spec.series.filter((s) => s.name !== "" && s.hidden !== true);
    const top = spec.title ? 30 : 4;
    const whole = top + height + 10 + 20 * shown.length;
    const svg = makeSvg("svg", {
        xmlns: "http://www.w3.org/2000/svg",
        width,
        height: whole,
        viewBox: `0 0 ${width} ${whole}`,
        "font-family": FAMILIES,
        "font-size": 13,
    });
    svg.append(makeSvg("rect", { width: "100%", height: "100%", fill: "white" }));
    const text = (/** @type {string} */ words, /** @type {Record<string, string | number>} */ place) => {
        const element = makeSvg("text", { fill: "#222222", ...place });
        setRaised(element, words);
        svg.append(element);
    };
    if (spec.title) {
        text(spec.title, { x: 12, y: 20, "font-weight": "bold" });
    }
    const plot = makeSvg("g", { transform: `translate(0 ${top})`, "text-anchor": "middle", fill: "#222222", "font-size": 13 });
    for (const child of drawn.children) {
        if (child.tagName !== "style" && !child.classList.contains("picked")) {
            plot.append(child.cloneNode(true));
        }
    }
    svg.append(plot);
    shown.forEach((series, i) => {
        const y = top + height + 4 + 20 * i;
        const sample = sampleOf(series);
        sample.setAttribute("transform", `translate(12 ${y})`);
        svg.append(sample);
        text(legendText(series), { x: 54, y: y + 12 });
    });
    return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(svg)}\n`;
}
