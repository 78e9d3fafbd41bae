// Pages in a real browser: the system's Chromium, headless, without network.
import { chromium } from "playwright-core";
import { pathToFileURL } from "node:url";

const ARGUMENTS = ["--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

/** Opens a file; `errors` collects what the console and the page complain of. */
export async function openPage(path, { width = 1280, height = 800, colorScheme = "light", args = [], ...more } = {}) {
    const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: [...ARGUMENTS, ...args] });
    const page = await browser.newPage({ viewport: { width, height }, colorScheme, ...more });
    const errors = [];
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("close", () => browser.close());
    await page.goto(pathToFileURL(path).href);
    return { page, errors };
}
