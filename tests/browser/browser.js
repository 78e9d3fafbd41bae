// What the tests of pages share: the system's Chromium, a page opened from disk, and axe.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const require = createRequire(import.meta.url);

/** @type {Promise<import("playwright-core").Browser> | undefined} */
let started;

const browser = () => {
    started ??= chromium.launch({
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
    });
    return started;
};

/** Ends the browser, if there is one. */
export const close = async () => {
    const running = started;
    started = undefined;
    await (await running)?.close();
};

/**
 * Opens a page from disk. `errors` grows by what its console complains of, what its script throws, and what it asks of a network.
 * @param {string} path
 * @param {{ width?: number, height?: number, colorScheme?: "light" | "dark", hasTouch?: boolean }} [options]
 */
export const openPage = async (path, { width = 1280, height = 800, colorScheme = "light", hasTouch = false } = {}) => {
    const context = await (await browser()).newContext({ viewport: { width, height }, colorScheme, hasTouch, acceptDownloads: true });
    const page = await context.newPage();
    /** @type {string[]} */
    const errors = [];
    page.on("console", (message) => {
        if (["error", "warning"].includes(message.type())) {
            errors.push(message.text());
        }
    });
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("request", (request) => {
        if (!/^(file|data|blob):/.test(request.url())) {
            errors.push(`asks a network for ${request.url()}`);
        }
    });
    await page.goto(pathToFileURL(path).href);
    return { page, errors };
};

/**
 * The serious and critical violations that axe finds.
 * @param {import("playwright-core").Page} page
 */
export const axe = async (page) => {
    await page.evaluate(readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"));
    const found = await page.evaluate(async () => (await /** @type {any} */ (window).axe.run()).violations);
    const serious = found.filter((/** @type {any} */ v) => ["serious", "critical"].includes(v.impact));
    return serious.map((/** @type {any} */ v) => `${v.id}: ${v.help}: ${v.nodes.map((/** @type {any} */ n) => n.html.slice(0, 160)).slice(0, 3).join(" | ")}`);
};
