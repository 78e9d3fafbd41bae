// Where the entries of Φcam come from: the page itself, or `phicam serve`.

/**
 * What the page says about the run; see `circumstances` of explorer.rs.
 * @typedef {{
 *   unit: string, columns: number, rows: number, spots: number, every: number, embedded: number[], step: number, bits: [number, number, number] | null,
 *   places: [number, number, number][],
 *   view: { corner: number[], u: number[], v: number[] }, axes: { right: number[], up: number[] },
 *   range: [number, number] | null, residual: number | null, stderr: number | null, limit: number | null, model: boolean, tails: [number, string][], hash: string, seed: string,
 * }} Circumstances
 */

/** @typedef {"traced" | "modelled" | "stderr" | "z" | "tails"} MatrixName */

/**
 * A part of a frame: the middle one of each block of `step` × `step` pixels from (x, y) on.
 * @typedef {{ x: number, y: number, w: number, h: number, step: number }} Box
 */

/**
 * @typedef {{
 *   every: number,
 *   spots: number[],
 *   served: boolean,
 *   has: (name: MatrixName) => boolean,
 *   frame: (name: MatrixName, spot: number, box: Box) => Promise<ArrayLike<number>> | ArrayLike<number>,
 *   row: (name: MatrixName, pixel: number) => Promise<ArrayLike<number>> | ArrayLike<number>,
 * }} Source
 */

/**
 * The index of the middle one of the block of `every` that holds index i, out of n.
 * @param {number} i
 * @param {number} every
 * @param {number} n
 */
function middle(i, every, n) {
    const start = i - (i % every);
    return Math.floor((start + Math.min(start + every, n) - 1) / 2);
}

/**
 * Columns and rows of a box.
 * @param {Box} box
 * @returns {[number, number]}
 */
function extent({ w, h, step }) {
    return [Math.ceil(w / step), Math.ceil(h / step)];
}

/**
 * What lies in the page.
 * @param {Circumstances} about
 * @returns {Promise<Source>}
 */
async function embedded(about) {
    const names = /** @type {MatrixName[]} */ (["traced", "modelled", "stderr", "z", "tails"]);
    const blocks = await Promise.all(names.map((name) => numbers(`phi-${name}`)));
    /** @type {Map<MatrixName, Float32Array | Float64Array>} */
    const all = new Map();
    blocks.forEach((block, i) => block !== undefined && all.set(names[i], block));
    const { every, embedded: spots } = about;
    const [columns, rows] = extent({ x: 0, y: 0, w: about.columns, h: about.rows, step: every });
    const each = columns * rows;
    const block = (/** @type {MatrixName} */ name) => {
        const found = all.get(name);
        if (found === undefined) {
            throw new Error(`the page has no matrix ${name}`);
        }
        return found;
    };
    return {
        every,
        spots,
        served: false,
        has: (name) => all.has(name),
        frame(name, spot, box) {
            const k = spots.indexOf(spot);
            if (k < 0) {
                throw new Error(`the page has no frame of spot ${spot}`);
            }
            const frame = block(name).subarray(k * each, (k + 1) * each);
            const [w, h] = extent(box);
            if (w === columns && h === rows && box.x === 0 && box.y === 0) {
                return frame;
            }
            const part = new Float64Array(w * h);
            for (let j = 0; j < h; j++) {
                const y = middle(box.y + j * box.step, box.step, about.rows);
                for (let i = 0; i < w; i++) {
                    const x = middle(box.x + i * box.step, box.step, about.columns);
                    part[i + j * w] = frame[Math.floor(x / every) + Math.floor(y / every) * columns];
                }
            }
            return part;
        },
        row(name, pixel) {
            const at = Math.floor((pixel % about.columns) / every) + Math.floor(Math.floor(pixel / about.columns) / every) * columns;
            const matrix = block(name);
            return Float64Array.from(spots, (_, k) => matrix[at + k * each]);
        },
    };
}

/**
 * What `phicam serve` hands out, every entry of it; `undefined` where the page was opened from disk, or the server has a run of another scene or seed.
 * @param {Circumstances} about
 * @returns {Promise<Source | undefined>}
 */
async function served(about) {
    if (!location.protocol.startsWith("http")) {
        return undefined;
    }
    const answer = await fetch("api/about").catch(() => undefined);
    if (answer === undefined || !answer.ok) {
        return undefined;
    }
    const { pixels, spots, matrices, hash, seed } = await answer.json();
    const same = hash === about.hash && String(seed) === about.seed;
    if (!same || pixels[0] !== about.columns || pixels[1] !== about.rows || spots !== about.spots) {
        return undefined;
    }
    /** @type {Map<string, Promise<Float64Array>>} */
    const kept = new Map();
    const ask = (/** @type {string} */ address) => {
        let values = kept.get(address);
        if (values === undefined) {
            values = fetch(address).then(async (a) => {
                if (!a.ok) {
                    throw new Error(await a.text());
                }
                return new Float64Array(await a.arrayBuffer());
            });
            // What went wrong once may go well the next time.
            values.catch(() => kept.delete(address));
            kept.set(address, values);
            // A few dozen answers of at most 2 MiB are kept.
            if (kept.size > 48) {
                kept.delete(/** @type {string} */ (kept.keys().next().value));
            }
        }
        return values;
    };
    return {
        every: 1,
        spots: Array.from({ length: spots }, (_, i) => i),
        served: true,
        has: (name) => matrices.includes(name),
        frame: (name, spot, { x, y, w, h, step }) => ask(`api/frame?matrix=${name}&spot=${spot}&x=${x}&y=${y}&w=${w}&h=${h}&step=${step}`),
        row: (name, pixel) => ask(`api/row?matrix=${name}&pixel=${pixel}`),
    };
}
