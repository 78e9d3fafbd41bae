// Long lines, as few points as look the same: of neighbours that share less than a pixel the least and the greatest.

/**
 * The rows of a line that are drawn on `width` pixels, in their order: all, or of each run of neighbours the least and the greatest, and the ends of gaps.
 * @param {ArrayLike<number>} ys
 * @param {number} width
 * @returns {number[]}
 */
function thinned(ys, width) {
    const each = Math.floor(ys.length / width);
    if (each < 3) {
        return Array.from({ length: ys.length }, (_, i) => i);
    }
    /** @type {number[]} */
    const kept = [];
    for (let from = 0; from < ys.length; from += each) {
        const to = Math.min(ys.length, from + each);
        let [low, high, gap] = [-1, -1, -1];
        for (let i = from; i < to; i++) {
            if (Number.isNaN(ys[i])) {
                gap = i;
            } else {
                low = low < 0 || ys[i] < ys[low] ? i : low;
                high = high < 0 || ys[i] > ys[high] ? i : high;
            }
        }
        const found = [low, high, gap].filter((i) => i >= 0).sort((a, b) => a - b);
        kept.push(...found.filter((i, k) => i !== found[k - 1]));
    }
    return kept;
}

/**
 * The same of a band: each run of neighbours at its middle, from the least of the low ends to the greatest of the high ones.
 * @param {ArrayLike<number>} xs
 * @param {ArrayLike<number>} low
 * @param {ArrayLike<number>} high
 * @param {number} width
 */
function thinnedBand(xs, low, high, width) {
    const each = Math.max(1, Math.floor(xs.length / width));
    const runs = Array.from({ length: Math.ceil(xs.length / each) }, (_, k) => [k * each, Math.min(xs.length, (k + 1) * each)]);
    const over = (/** @type {ArrayLike<number>} */ values, /** @type {(...all: number[]) => number} */ pick) => runs.map(([from, to]) => {
        let found = values[from];
        for (let i = from + 1; i < to; i++) {
            found = pick(found, values[i]);
        }
        return found;
    });
    return { x: runs.map(([from, to]) => xs[(from + to - 1) >> 1]), low: over(low, Math.min), high: over(high, Math.max) };
}
