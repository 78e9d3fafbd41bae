// Frames side by side: traced, modelled, residual and z, with their colour scales.

/**
 * A frame with its title, its legend and the value under the pointer.
 * @param {{ title: string, unit: string, map: MapName, explanation: string }} layer
 * @param {(x: number, y: number) => void} pick shares of the width and of the height (from below) that are pointed at
 */
function framePanel({ title, unit, map, explanation }, pick) {
    const canvas = make("canvas", { role: "img", "aria-label": title });
    const mark = make("span", { class: "cross", "aria-hidden": "true" });
    const bar = make("canvas", { width: 256, height: 1, class: "bar-scale", "aria-hidden": "true" });
    paint(bar, Float64Array.from({ length: 256 }, (_, i) => i), [256, 1], map, [0, 255]);
    const [low, high, outside] = [make("span"), make("span"), make("p", { class: "note" })];
    const under = make("p", { class: "note under" }, "\u00a0");
    const name = make("abbr", { title: explanation, tabindex: 0 }, title);
    const element = make(
        "figure",
        { class: "frame" },
        make("figcaption", {}, make("b", {}, name), ` / ${unit}`),
        make("div", { class: "picture" }, canvas, mark),
        make("div", { class: "legend" }, low, bar, high),
        outside,
        under,
    );
    const shares = (/** @type {PointerEvent} */ event) => {
        const box = canvas.getBoundingClientRect();
        return [(event.clientX - box.left) / box.width, (box.bottom - event.clientY) / box.height].map((s) => Math.min(1 - 1e-9, Math.max(0, s)));
    };
    /** @type {{ values: ArrayLike<number>, size: [number, number] }} */
    let shown = { values: [], size: [1, 1] };
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        const [x, y] = shares(event);
        pick(x, y);
    });
    canvas.addEventListener("pointermove", (event) => {
        const [x, y] = shares(event);
        const value = shown.values[Math.floor(x * shown.size[0]) + Math.floor(y * shown.size[1]) * shown.size[0]];
        under.textContent = `under the pointer: ${significant(value)} ${unit}`;
        if (event.buttons === 1) {
            pick(x, y);
        }
    });
    canvas.addEventListener("pointerleave", () => {
        under.textContent = "\u00a0";
    });
    return {
        element,
        /**
         * @param {ArrayLike<number>} values
         * @param {[number, number]} size
         * @param {[number, number]} range
         * @param {[number, number]} at shares of width and height of the chosen pixel's middle
         * @param {[number, number]} each its width and height as shares
         * @param {number} aspect width over height
         */
        show(values, size, range, at, each, aspect) {
            shown = { values, size };
            paint(canvas, values, size, map, range);
            low.textContent = significant(range[0]);
            high.textContent = significant(range[1]);
            let beyond = 0;
            for (let i = 0; i < values.length; i++) {
                beyond += values[i] >= range[0] && values[i] <= range[1] ? 0 : 1;
            }
            outside.textContent = beyond > 0 ? `${beyond} of ${values.length} outside of the scale, in colours of their own` : "";
            mark.hidden = !(at[0] > 0 && at[0] < 1 && at[1] > 0 && at[1] < 1);
            mark.style.left = `${100 * at[0]}%`;
            mark.style.bottom = `${100 * at[1]}%`;
            mark.style.width = `max(${100 * each[0]}%, 7px)`;
            mark.style.height = `max(${100 * each[1]}%, 7px)`;
            // A strip is widened until it can be seen.
            canvas.style.aspectRatio = String(Math.min(4, Math.max(0.25, aspect)));
        },
    };
}

/**
 * The finite range of values; something to draw with where there is none.
 * @param {ArrayLike<number>[]} all
 * @returns {[number, number]}
 */
function rangeOf(all) {
    let [low, high] = [Infinity, -Infinity];
    for (const values of all) {
        for (let i = 0; i < values.length; i++) {
            if (Number.isFinite(values[i])) {
                low = Math.min(low, values[i]);
                high = Math.max(high, values[i]);
            }
        }
    }
    return low < high ? [low, high] : low === high ? [Math.min(0, low), Math.max(0, low) || 1] : [0, 1];
}

/**
 * A range around 0.
 * @param {number} limit
 * @returns {[number, number]}
 */
function around(limit) {
    return limit > 0 && Number.isFinite(limit) ? [-limit, limit] : [-1, 1];
}
