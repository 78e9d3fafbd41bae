// A real browser for the tests: Debian's Chromium, without network.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

import { chromium } from "playwright-core";

const require = createRequire(import.meta.url);
const AXE = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

/** Chromium without what it would ask the network for; WebGL by software, as there is no graphics processor to count on. */
const ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--enable-unsafe-swiftshader",
];

/** @type {Set<import("playwright-core").Browser>} */
const running = new Set();

/** Ends every browser that is still there. */
export async function close() {
    await Promise.all([...running].map((browser) => browser.close()));
    running.clear();
}

/**
 * Opens a page from disk or from an address of this machine. What the console calls an error, what is thrown, and what is asked of any other place, is in `errors`.
 */
export async function openPage(path, { width = 1280, height = 800, colorScheme = "light", args = [], rewrite = undefined, ...device } = {}) {
    const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...ARGUMENTS, ...args] });
    running.add(browser);
    const page = await browser.newPage({ viewport: { width, height }, colorScheme, acceptDownloads: true, ...device });
    const errors = [];
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(String(error)));
    const address = /^http:/.test(path) ? path : `file://${path}`;
    page.on("request", (request) => {
        const here = request.url() === address || /^(data|blob):/.test(request.url()) || request.url().startsWith(new URL("/", address).href);
        if (!here || (address.startsWith("file:") && /^file:/.test(request.url()) && request.url() !== address)) {
            errors.push(`asked for ${request.url().slice(0, 200)}`);
        }
    });
    if (rewrite !== undefined) {
        await page.route(address, async (route) => {
            const answer = await route.fetch();
            await route.fulfill({ response: answer, body: rewrite(await answer.text()) });
        });
    }
    const start = performance.now();
    await page.goto(address, { waitUntil: "load" });
    if (device.javaScriptEnabled !== false) {
        await page.waitForFunction(() => document.documentElement.dataset.ready === "yes");
    }
    return { page, browser, errors, seconds: (performance.now() - start) / 1000 };
}

/** Violations of accessibility that axe-core calls serious or critical, in words. */
export async function axe(page) {
    await page.evaluate(AXE);
    const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    return violations
        .filter((v) => v.impact === "serious" || v.impact === "critical")
        .map((v) => `${v.id}: ${v.help} (${v.nodes.length}×, e.g. ${v.nodes[0].html.slice(0, 160)})`);
}

/** The elements that the Tab key reaches, in its order, each as its HTML's beginning, with whether its focus can be seen. */
export async function tabbed(page, most = 2000) {
    // Where the last click was is where Tab would go on from: a focus before the page's first element starts anew.
    await page.evaluate(() => {
        const first = document.createElement("span");
        first.tabIndex = -1;
        document.body.prepend(first);
        first.focus();
    });
    const reached = [];
    for (let i = 0; i < most; i++) {
        await page.keyboard.press("Tab");
        const found = await page.evaluate(() => {
            const element = document.activeElement;
            if (element === null || element === document.body || element.dataset.tabbed === "yes") {
                return undefined;
            }
            element.dataset.tabbed = "yes";
            const style = getComputedStyle(element);
            return { html: element.outerHTML.slice(0, 120), seen: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0 };
        });
        if (found === undefined) {
            break;
        }
        reached.push(found);
    }
    return reached;
}

/** Shape and values of an .npy file of f64 in C order. */
export function npy(path) {
    const bytes = readFileSync(path);
    const head = bytes.readUInt16LE(8);
    const header = bytes.subarray(10, 10 + head).toString("latin1");
    if (!header.includes("'<f8'") || !header.includes("'fortran_order': False")) {
        throw new Error(`${path}: ${header}`);
    }
    const shape = /\(([^)]*)\)/.exec(header)[1].split(",").filter((t) => t.trim()).map(Number);
    const from = bytes.subarray(10 + head);
    const values = new Float64Array(from.buffer.slice(from.byteOffset, from.byteOffset + from.length));
    return { shape, at: (row, column) => values[row * shape[1] + column] };
}

/** Uniform random numbers of a seed (mulberry32). */
export function random(seed) {
    let a = seed >>> 0;
    return () => {
        a = (a + 0x6d2b79f5) >>> 0;
        let t = Math.imul(a ^ (a >>> 15), 1 | a);
        t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
}
