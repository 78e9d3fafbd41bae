// Axes of plots: where they end, where their ticks are and what these say. The same as in the static figures (axis.rs).

/** @typedef {"linear" | "logarithmic"} AxisRun */
/** @typedef {{ title: string, run: AxisRun, ends?: [number, number] | undefined }} PlotAxis what it shows with its unit, how it runs, and its ends: by the values where they are missing */

/**
 * The ends of an axis for these values: decades around the positive ones, or a little beyond all of them.
 * @param {AxisRun} run
 * @param {Iterable<number>} values
 * @returns {[number, number]}
 */
function endsOf(run, values) {
    let low = Infinity;
    let high = -Infinity;
    for (const x of values) {
        if (Number.isFinite(x) && (run === "linear" || x > 0)) {
            low = Math.min(low, x);
            high = Math.max(high, x);
        }
    }
    if (run === "logarithmic") {
        if (low > high) {
            return [0.1, 1];
        }
        const first = Math.floor(Math.log10(low));
        return [10 ** first, 10 ** Math.max(Math.ceil(Math.log10(high)), first + 1)];
    }
    if (low > high) {
        return [0, 1];
    }
    const beyond = low < high ? 0.03 * (high - low) : 1;
    return [low - beyond, high + beyond];
}

/**
 * Ticks of an axis with their texts; decades beyond `most` have a line and no text.
 * @param {AxisRun} run
 * @param {[number, number]} ends
 * @param {number} most
 * @returns {Map<number, string>}
 */
function ticksOf(run, [low, high], most) {
    /** @type {Map<number, string>} */
    const found = new Map();
    if (run === "logarithmic") {
        const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
        const each = Math.max(1, Math.floor((last - first + most) / most));
        for (let n = first; n <= last; n++) {
            found.set(10 ** n, n % each === 0 ? `10${raised(n)}` : "");
        }
        return found;
    }
    const span = high - low;
    const power = 10 ** Math.floor(Math.log10(span / most));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= (span / most) * (1 - 1e-9));
    if (!(span > 0) || step === undefined || !Number.isFinite(step)) {
        return found;
    }
    const first = Math.ceil(low / step - 1e-9);
    for (let k = 0; k <= most; k++) {
        const x = (first + k) * step;
        if (x > high + 1e-9 * step) {
            break;
        }
        found.set(x, tickText(x));
    }
    return found;
}

/**
 * A number without superfluous digits: 0.5, 20, 2 × 10⁻¹².
 * @param {number} x
 */
function tickText(x) {
    const short = Number(x.toPrecision(6));
    const [mantissa, power] = short.toExponential().split("e").map(Number);
    const sign = (/** @type {number} */ n) => String(n).replace("-", "−");
    if (short === 0 || (power >= -3 && power < 5)) {
        return sign(short);
    }
    return mantissa === 1 ? `10${raised(power)}` : `${sign(mantissa)} × 10${raised(power)}`;
}

/**
 * A value for people: whole numbers whole, others with three significant digits.
 * @param {number} x
 */
function valueText(x) {
    return Number.isInteger(x) && Math.abs(x) < 1e6 ? String(x).replace("-", "−") : significant(x, 3);
}

/** Signs that Unicode has raised, and what they are. */
const RAISED = new Map([..."⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ᵀ"].map((sign, i) => [sign, "0123456789−+T"[i]]));

/**
 * Fills a text with raised signs as small ordinary ones above the line, as svg.rs sets them: a viewer's type need not have the raised ones.
 * @param {SVGTextElement} element
 * @param {string} text
 */
function setRaised(element, text) {
    element.replaceChildren();
    let below = false;
    for (const run of text.match(/[⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ᵀ]+|[^⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ᵀ]+/g) ?? []) {
        if (RAISED.has(run[0])) {
            const plain = [...run].map((c) => RAISED.get(c)).join("");
            element.append(makeSvg("tspan", { "font-size": "70%", dy: "-0.5em" }, plain));
            below = true;
        } else if (below) {
            element.append(makeSvg("tspan", { dy: "0.35em" }, run));
            below = false;
        } else {
            element.append(run);
        }
    }
}
