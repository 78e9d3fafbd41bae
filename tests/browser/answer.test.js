// The first screen of a run's report, and what every screen has to hold: PHICAM_RUN is the folder of a run of `bench`.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { after, describe, test } from "node:test";

import { axe, close, openPage } from "./browser.js";

const report = join(resolve(process.env.PHICAM_RUN ?? "out"), "report.html");
const pictures = process.env.PHICAM_PICTURES;

const SIZES = [[1280, 800], [820, 1180], [390, 844]];

after(close);

/** The boxes of what a selector names, in CSS pixels from the upper left corner of the screen. */
const boxes = (page, selector) =>
    page.$$eval(selector, (all) => all.map((e) => {
        const { left, top, right, bottom } = e.getBoundingClientRect();
        return { left, top, right, bottom, width: right - left, height: bottom - top };
    }));

for (const [width, height] of SIZES) {
    for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
        describe(`${width} × ${height}, ${colorScheme}`, () => {
            let page, errors;
            test("opens", async () => {
                ({ page, errors } = await openPage(report, { width, height, colorScheme }));
                if (pictures !== undefined) {
                    mkdirSync(pictures, { recursive: true });
                    await page.screenshot({ path: join(pictures, `first-${width}-${colorScheme}.png`) });
                }
            });

            test("the answer is on the first screen: truth, recovered, its error, how sure, whether the light agrees", async () => {
                const shots = await boxes(page, "#answer .shot svg");
                const claims = await boxes(page, "#answer .claim");
                assert.deepEqual([shots.length, claims.length], [3, 4]);
                for (const box of [...shots, ...claims]) {
                    assert.ok(box.left >= 0 && box.top >= 0 && box.right <= width && box.bottom <= height, JSON.stringify(box));
                }
                // Eight elements a side are told apart, and no claim lies over another one.
                assert.ok(shots.every((box) => box.width >= 96 && box.height >= 96), JSON.stringify(shots));
                assert.ok(claims.every((box, i) => i === 0 || box.top >= claims[i - 1].bottom));
                assert.deepEqual(await page.$$eval("#answer .claim b", (all) => all.map((e) => e.textContent)), ["Hidden:", "Recovered:", "How sure:", "Agreement:"]);
                assert.match(await page.textContent("#answer .claim:last-child"), /agree: χ²\/dof .*could have missed/);
            });

            test("the page is no wider than the screen, and tables that are say that they scroll", async () => {
                assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width);
                // The sentence follows the size of the table a moment later.
                await page.waitForTimeout(200);
                const tables = await page.$$eval(".wide", (all) => all.map((box) => {
                    const words = box.previousElementSibling;
                    return { wider: box.scrollWidth > box.clientWidth + 1, says: words?.matches(".scrolls") === true && words.getClientRects().length > 0 };
                }));
                assert.ok(tables.length > 4);
                assert.deepEqual(tables.filter(({ wider, says }) => wider !== says), []);
                assert.ok(width > 390 || tables.some(({ wider }) => wider), "no table is wider than a phone");
            });

            test("there is one drawing of the bench", async () => {
                const seen = (selector) => page.locator(selector).isVisible();
                assert.deepEqual([await seen("#bench-3d canvas"), await seen("figure.bench")], [true, false]);
            });

            test("axe-core finds no serious violation, with bad news either", async () => {
                assert.deepEqual(await axe(page), []);
                await page.$$eval("#answer .agree", (all) => all.forEach((e) => e.classList.replace("agree", "disagree")));
                assert.deepEqual(await axe(page), []);
                assert.deepEqual(errors, []);
            });

            test("dark is dark throughout", { skip: colorScheme === "light" }, async () => {
                const light = await page.evaluate(() => {
                    const brightness = (/** @type {string} */ colour) => {
                        const [r, g, b, a = 1] = (colour.match(/[\d.]+/g) ?? []).map(Number);
                        return a === 0 || !colour.startsWith("rgb") ? 0 : 0.2126 * r + 0.7152 * g + 0.0722 * b;
                    };
                    return [...document.querySelectorAll("body, body *")].filter((e) => {
                        const { width: w, height: h } = e.getBoundingClientRect();
                        const style = getComputedStyle(e);
                        const ground = e instanceof SVGRectElement && style.fillOpacity === "1" ? style.fill : style.backgroundColor;
                        return w * h > 6000 && brightness(ground) > 100;
                    }).map((e) => e.outerHTML.slice(0, 120));
                });
                assert.deepEqual(light, []);
            });
        });
    }
}

test("without a script the answer and the drawing of the bench are there", async () => {
    const { page } = await openPage(report, { width: 1280, height: 800, javaScriptEnabled: false });
    const [shots, claims] = [await boxes(page, "#answer .shot svg"), await boxes(page, "#answer .claim")];
    assert.deepEqual([shots.length, claims.length], [3, 4]);
    assert.ok([...shots, ...claims].every((box) => box.width > 90 && box.bottom <= 800));
    assert.ok(await page.locator("figure.bench svg").isVisible());
});
