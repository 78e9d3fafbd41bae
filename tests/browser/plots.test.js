// The plots of a study's page, in a real browser. PHICAM names the program; the target folder's unless given.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { axe, close, openPage } from "./browser.js";

const program = process.env.PHICAM ?? join(import.meta.dirname, "../../target/debug/phicam");
const folder = mkdtempSync(join(tmpdir(), "phicam-plots-"));
const page = (/** @type {string} */ name) => join(folder, name);

before(() => {
    const run = (/** @type {string} */ line) => execFileSync(program, [...line.split(" "), "--quiet"], { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
    const bench = execFileSync(program, ["scene", "export", "bench"], { encoding: "utf8" });
    const small = bench.replace("pixels = [16, 16]", "pixels = [8, 8]").replace("per_side = 30", "per_side = 6");
    assert.notEqual(bench, small);
    execFileSync("tee", [join(folder, "small.toml")], { input: small, stdio: ["pipe", "ignore", "inherit"] });
    run("study convergence small.toml -o c --samples 64,256,1024");
    run("reproduce table3 -o r --most-elements 8 --seeds 2");
});

after(async () => {
    await close();
    rmSync(folder, { recursive: true, force: true });
});

/** The numbers of the study, by curve. */
const study = () => JSON.parse(readFileSync(page("c/convergence.json"), "utf8"));

/**
 * Rows of comma-separated values.
 * @param {string} text
 */
const rows = (text) => text.trim().split("\n").map((line) => Array.from(line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g), (m) => (m[1] ?? m[2]).replaceAll('""', '"')));

/**
 * What a click saves: the file's name and text.
 * @param {import("playwright-core").Page} open
 * @param {import("playwright-core").Locator} button
 */
const saved = async (open, button) => {
    const [download] = await Promise.all([open.waitForEvent("download"), button.click()]);
    return { name: download.suggestedFilename(), text: readFileSync(await download.path(), "utf8") };
};

/** Where a point of the first panel lies on the screen. */
const placeOf = (/** @type {import("playwright-core").Page} */ open, /** @type {number} */ series, /** @type {number} */ index) => open.evaluate(([s, i]) => {
    const told = JSON.parse(document.querySelector("figure.plot metadata")?.textContent ?? "");
    const svg = document.querySelector(".picture svg");
    const grid = /** @type {SVGGraphicsElement} */ (svg?.querySelector("[aria-label=frame], rect"));
    const box = grid.getBoundingClientRect();
    const share = (/** @type {any} */ axis, /** @type {number} */ x) => {
        const at = axis.run === "logarithmic" ? Math.log : Number;
        return (at(x) - at(axis.ends[0])) / (at(axis.ends[1]) - at(axis.ends[0]));
    };
    const [x, y] = told.series[s].points[i];
    return { x: box.left + box.width * share(told.x, x), y: box.bottom - box.height * share(told.y, y) };
}, [series, index]);

test("a study's page opens from disk without a word of complaint", async () => {
    const { page: open, errors } = await openPage(page("c/report.html"));
    await open.locator(".picture svg").waitFor();
    assert.deepEqual(errors, []);
    assert.match(await open.locator(".verdict").innerText(), /slope/);
    assert.ok(readFileSync(page("c/report.html")).length < 10e6);
    assert.equal(await open.locator("figure.plot > svg").isVisible(), false);
});

test("hover says the value of the point", async () => {
    const { page: open } = await openPage(page("c/report.html"));
    await open.locator(".picture svg").waitFor();
    const all = study().curves.flatMap((/** @type {any} */ c, /** @type {number} */ s) => c.steps.map((/** @type {any} */ step, /** @type {number} */ i) => ({ c, s, step, i })));
    const places = await Promise.all(all.map((/** @type {any} */ p) => placeOf(open, p.s, p.i)));
    // Where points lie within two pixels of each other the mouse cannot tell them apart.
    const alone = places.map((p) => places.every((q) => q === p || Math.hypot(p.x - q.x, p.y - q.y) > 2));
    assert.ok(alone.filter(Boolean).length >= 3);
    for (const [k, { c, step }] of all.entries()) {
        if (!alone[k]) {
            continue;
        }
        await open.mouse.move(places[k].x, places[k].y);
        const tip = await open.locator(".tip").innerText();
        const said = await open.locator(".read").innerText();
        const [mantissa, power] = step.error.toExponential(2).split("e").map(Number);
        const shown = power >= -3 ? step.error.toFixed(2 - power) : mantissa.toFixed(2);
        for (const words of [c.sampler, c.estimator, String(step.samples), shown]) {
            assert.ok(tip.includes(words), `${words} in ${tip}`);
            assert.ok(said.includes(words), `${words} in ${said}`);
        }
    }
    await open.mouse.move(2, 2);
    assert.equal(await open.locator(".tip").isVisible(), false);
});

test("a series goes and comes with its button", async () => {
    const { page: open } = await openPage(page("c/report.html"));
    const button = open.locator(".legend button").first();
    const lines = () => open.locator(".picture svg [aria-label=line] path").count();
    await open.locator(".picture svg").waitFor();
    assert.equal(await lines(), 6);
    await button.click();
    assert.equal(await button.getAttribute("aria-pressed"), "false");
    await assert.doesNotReject(open.waitForFunction(() => document.querySelectorAll(".picture svg [aria-label=line] path").length === 5));
    const at = await placeOf(open, 0, 0);
    await open.mouse.move(at.x, at.y);
    assert.ok(!(await open.locator(".tip b").innerText()).startsWith(`${study().curves[0].estimator}, ${study().curves[0].sampler}:`));
    await button.click();
    await assert.doesNotReject(open.waitForFunction(() => document.querySelectorAll(".picture svg [aria-label=line] path").length === 6));
});

test("an axis is by decades or even", async () => {
    const { page: open } = await openPage(page("c/report.html"));
    const box = open.getByLabel("log x", { exact: false });
    assert.ok(await box.isChecked());
    const ticks = () => open.locator(".picture svg [aria-label='x-axis tick label'] text").allTextContents();
    assert.ok((await ticks()).some((t) => t.startsWith("10")), String(await ticks()));
    await box.uncheck();
    await open.waitForFunction(() => [...document.querySelectorAll(".picture svg [aria-label='x-axis tick label'] text")].some((t) => t.textContent === "400"));
});

test("what is saved is what is shown", async () => {
    const { page: open } = await openPage(page("c/report.html"));
    const csv = await saved(open, open.getByRole("button", { name: /^CSV of/ }));
    assert.equal(csv.name, "convergence.csv");
    const [head, ...lines] = rows(csv.text);
    assert.deepEqual(head.slice(0, 2), ["series", "source"]);
    const steps = study().curves.flatMap((/** @type {any} */ c) => c.steps);
    assert.equal(lines.length, steps.length);
    lines.forEach((line, i) => assert.deepEqual(line.slice(2).map(Number), [steps[i].samples, steps[i].error]));
    await open.locator(".legend button").first().click();
    const svg = await saved(open, open.getByRole("button", { name: /^SVG of/ }));
    const read = await open.evaluate((text) => {
        const whole = new DOMParser().parseFromString(text, "image/svg+xml");
        const words = [...whole.querySelectorAll("text")].map((t) => t.textContent);
        return { wrong: whole.querySelector("parsererror") !== null, lines: whole.querySelectorAll("[aria-label=line] path").length, words };
    }, svg.text);
    assert.equal(read.wrong, false);
    assert.equal(read.lines, 5);
    assert.ok(read.words.includes("‖Φ̂ − Φ‖ / ‖Φ‖"), String(read.words));
    assert.ok(!svg.text.includes("currentColor") && !svg.text.includes("<style"));
    const data = await saved(open, open.getByRole("link", { name: "convergence.json" }));
    assert.equal(data.text, readFileSync(page("c/convergence.json"), "utf8"));
});

test("the keyboard alone reads a plot", async () => {
    const { page: open } = await openPage(page("c/report.html"));
    await open.locator(".picture svg").waitFor();
    const there = () => open.evaluate(() => document.activeElement?.classList.contains("picture") ?? false);
    for (let i = 0; i < 100 && !(await there()); i++) {
        await open.keyboard.press("Tab");
    }
    assert.ok(await there());
    const said = () => open.locator(".read").innerText();
    await open.keyboard.press("ArrowRight");
    assert.match(await said(), /: 64;/);
    await open.keyboard.press("ArrowRight");
    assert.match(await said(), /: 256;/);
    const before = (await said()).split(":")[0];
    await open.keyboard.press("ArrowDown");
    assert.match(await said(), /: 256;/);
    assert.notEqual((await said()).split(":")[0], before);
    await open.keyboard.press("End");
    assert.match(await said(), /: 1024;/);
    await open.keyboard.press("Escape");
    assert.equal(await said(), "");
    // On to the boxes and buttons.
    await open.keyboard.press("Tab");
    await open.keyboard.press("Space");
    assert.equal(await open.getByLabel("log x", { exact: false }).isChecked(), false);
});

test("published points lie over the computed ones", async () => {
    const { page: open, errors } = await openPage(page("r/reproduction.html"));
    await open.locator(".picture svg").first().waitFor();
    assert.deepEqual(errors, []);
    assert.match(await open.locator(".verdict").innerText(), /1 reproduced/);
    const names = await open.locator(".legend button").allInnerTexts();
    assert.equal(names.filter((n) => n.includes("(published)")).length, 2);
    const csv = await saved(open, open.getByRole("button", { name: /^CSV of/ }).first());
    assert.equal(rows(csv.text).filter((r) => r[1] === "published").length, 16);
});

for (const [width, height] of [[1280, 800], [360, 740]]) {
    for (const colorScheme of /** @type {const} */ (["light", "dark"])) {
        test(`${width} × ${height}, ${colorScheme}: nothing serious for axe, nothing beyond the edge`, async () => {
            for (const name of ["c/report.html", "r/reproduction.html"]) {
                const { page: open } = await openPage(page(name), { width, height, colorScheme });
                await open.locator(".picture svg").first().waitFor();
                assert.deepEqual(await axe(open), []);
                const beyond = await open.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
                assert.ok(beyond <= 0, `${name}: ${beyond} px too wide`);
            }
        });
    }
}
