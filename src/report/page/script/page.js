// What every part of the page's script stands on: elements, data, numbers as text, colours, and what is chosen.

/** What has been started; when all of it is there the page says so: `data-ready` of its root. @type {Promise<void>[]} */
const started = [];
setTimeout(async () => {
    await Promise.allSettled(started);
    document.documentElement.dataset.ready = "yes";
});

/**
 * Calls `start` for each element of the page that `selector` names, once every part of the script is there. An error in one leaves the others alone, and that element says it.
 * @param {string} selector
 * @param {(element: HTMLElement) => void | Promise<void>} start
 */
function upgrade(selector, start) {
    for (const element of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll(selector))) {
        const running = Promise.resolve().then(() => start(element)).catch((error) => {
            console.error(error);
            element.prepend(make("p", { class: "note" }, `This part of the page does not answer: ${error}`));
        });
        started.push(running);
    }
}

/**
 * An element with attributes (functions are listeners, `undefined` and `false` leave an attribute out) and children.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, string | number | boolean | undefined | ((event: any) => void)>} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[T]}
 */
function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    dress(element, attributes, children);
    return element;
}

/**
 * The same for SVG.
 * @template {keyof SVGElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, string | number | boolean | undefined | ((event: any) => void)>} [attributes]
 * @param {...(Node | string)} children
 * @returns {SVGElementTagNameMap[T]}
 */
function makeSvg(tag, attributes = {}, ...children) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    dress(element, attributes, children);
    return element;
}

/**
 * @param {Element} element
 * @param {Record<string, string | number | boolean | undefined | ((event: any) => void)>} attributes
 * @param {(Node | string)[]} children
 */
function dress(element, attributes, children) {
    for (const [name, value] of Object.entries(attributes)) {
        if (typeof value === "function") {
            element.addEventListener(name, value);
        } else if (value !== undefined && value !== false) {
            element.setAttribute(name, value === true ? "" : String(value));
        }
    }
    element.append(...children);
}

/**
 * The values of a data block, or `undefined` where the page has none of that name.
 * @param {string} id
 * @returns {any}
 */
function data(id) {
    const text = document.getElementById(id)?.textContent;
    return text === undefined || text === null ? undefined : JSON.parse(text);
}

/**
 * The numbers of a packed block: see `packed.rs`, whose steps are taken back.
 * @param {string} id
 * @returns {Promise<Float32Array | Float64Array | undefined>}
 */
async function numbers(id) {
    const block = document.getElementById(id);
    if (block === null) {
        return undefined;
    }
    const [count, width, order] = [block.dataset.count, block.dataset.width, block.dataset.order].map(Number);
    const text = atob(block.textContent ?? "");
    const packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) {
        packed[i] = text.charCodeAt(i);
    }
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const planes = new Uint8Array(await new Response(stream).arrayBuffer());
    if (planes.length !== count * width) {
        throw new Error(`the block ${id} is not whole`);
    }
    const bytes = new Uint8Array(count * width);
    for (let k = 0; k < width; k++) {
        for (let i = 0, from = k * count; i < count; i++, from++) {
            bytes[i * width + k] = planes[from];
        }
    }
    const words = width === 8 ? new BigUint64Array(bytes.buffer) : new Uint32Array(bytes.buffer);
    for (let times = 0; times < order; times++) {
        for (let i = 1; i < count; i++) {
            // Typed arrays keep what fits, which is the sum modulo 2³² or 2⁶⁴.
            words[i] = /** @type {any} */ (words[i]) + words[i - 1];
        }
    }
    return width === 8 ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
}

/**
 * A number with at most so many significant digits, large and small ones as a·10ⁿ.
 * @param {number | null | undefined} x
 * @param {number} [digits]
 */
function significant(x, digits = 3) {
    if (x === null || x === undefined || Number.isNaN(x)) {
        return "–";
    }
    if (!Number.isFinite(x)) {
        return x > 0 ? "∞" : "−∞";
    }
    const [mantissa, exponent] = x.toExponential(digits - 1).split("e");
    const power = Number(exponent);
    const sign = (/** @type {string} */ text) => text.replace("-", "−");
    if (x === 0 || (power >= -3 && power < 5)) {
        const plain = Number(x.toPrecision(digits));
        return sign(Math.abs(plain) >= 1e5 ? plain.toFixed(0) : plain.toFixed(Math.max(0, digits - 1 - (x === 0 ? digits : power))));
    }
    return `${sign(mantissa)}\u202f×\u202f10${raised(power)}`;
}

/**
 * An integer in superscript digits.
 * @param {number} n
 */
function raised(n) {
    return [...String(n)].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)])).join("");
}

/** @typedef {"viridis" | "grey" | "diverging"} MapName */

/** @type {Map<string, Uint8ClampedArray>} */
const tables = new Map();

/**
 * The 256 colours of a map, three bytes each.
 * @param {MapName} map
 * @returns {Uint8ClampedArray}
 */
function coloursOf(map) {
    let table = tables.get(map);
    if (table === undefined) {
        const text = /** @type {Record<string, string>} */ (data("colours"))[map];
        table = Uint8ClampedArray.from({ length: text.length / 2 }, (_, i) => parseInt(text.slice(2 * i, 2 * i + 2), 16));
        tables.set(map, table);
    }
    return table;
}

/** Values below and above the range of a map, and such as are no numbers: the colours of the static pictures. */
const OUTSIDE = {
    viridis: { below: [0x00, 0x00, 0x00], above: [0xd5, 0x5e, 0x00] },
    grey: { below: [0x00, 0x72, 0xb2], above: [0xd5, 0x5e, 0x00] },
    diverging: { below: [0x00, 0x9e, 0x73], above: [0xf0, 0xe4, 0x42] },
};
const NOT_A_NUMBER = [0xcc, 0x79, 0xa7];

/**
 * Paints values, row 0 at the bottom, one pixel of the canvas each.
 * @param {HTMLCanvasElement} canvas
 * @param {ArrayLike<number>} values
 * @param {[number, number]} size columns and rows
 * @param {MapName} map
 * @param {[number, number]} range
 */
function paint(canvas, values, [columns, rows], map, [low, high]) {
    if (canvas.width !== columns || canvas.height !== rows) {
        canvas.width = columns;
        canvas.height = rows;
    }
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    const image = context.createImageData(columns, rows);
    const table = coloursOf(map);
    const { below, above } = OUTSIDE[map];
    const each = 255 / (high - low);
    for (let row = 0, to = 0; row < rows; row++) {
        for (let column = 0, from = (rows - 1 - row) * columns; column < columns; column++, from++, to += 4) {
            const x = values[from];
            let colour = /** @type {ArrayLike<number>} */ (table);
            let at = 0;
            if (x >= low && x <= high) {
                at = 3 * Math.round((x - low) * each);
            } else if (x < low) {
                colour = below;
            } else if (x > high) {
                colour = above;
            } else {
                colour = NOT_A_NUMBER;
            }
            image.data[to] = colour[at];
            image.data[to + 1] = colour[at + 1];
            image.data[to + 2] = colour[at + 2];
            image.data[to + 3] = 255;
        }
    }
    context.putImageData(image, 0, 0);
}

/** The spot and the pixel that all parts of the page show. */
const chosen = { spot: 0, pixel: 0 };
/** @type {((chosen: { spot: number, pixel: number }) => void)[]} */
const listeners = [];

/**
 * Calls `listener` whenever another spot or pixel is chosen.
 * @param {(chosen: { spot: number, pixel: number }) => void} listener
 */
function onChoice(listener) {
    listeners.push(listener);
}

/** What can be chosen: the nearest spot and pixel of which the page has numbers. @type {(choice: { spot: number, pixel: number }) => { spot: number, pixel: number }} */
let nearestKnown = (choice) => choice;

/**
 * Says what can be chosen.
 * @param {(choice: { spot: number, pixel: number }) => { spot: number, pixel: number }} nearest
 */
function limitChoice(nearest) {
    nearestKnown = nearest;
}

/**
 * Chooses a spot, a pixel or both.
 * @param {{ spot?: number, pixel?: number }} choice
 */
function choose(choice) {
    Object.assign(chosen, nearestKnown({ ...chosen, ...choice }));
    for (const listener of listeners) {
        listener(chosen);
    }
}
