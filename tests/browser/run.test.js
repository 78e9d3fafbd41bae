// The report of a run, in a real browser. PHICAM_RUN is its folder; pictures for people go to PHICAM_PICTURES, if given.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { after, before, describe, test } from "node:test";

import { axe, close, npy, openPage, random, tabbed } from "./browser.js";

const run = resolve(process.env.PHICAM_RUN ?? "out");
const report = join(run, "report.html");
const pictures = process.env.PHICAM_PICTURES;

/** The number that a text such as "−1.23 × 10⁻¹⁴" stands for. */
function parsed(text) {
    const plain = text.replace("−", "-").replaceAll("\u202f", "");
    const [mantissa, power] = plain.split("×10");
    const digits = [...(power ?? "")].map((c) => (c === "⁻" ? "-" : String("⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c)))).join("");
    return Number(mantissa) * 10 ** Number(digits || 0);
}

/** Sets a slider as a hand would. */
async function slide(page, selector, value) {
    await page.$eval(
        selector,
        (input, to) => {
            input.value = String(to);
            input.dispatchEvent(new Event("input", { bubbles: true }));
        },
        value,
    );
}

/** The chosen entry as the page says it. */
async function readout(page, spot, pixel) {
    await page.waitForFunction(
        ([s, p]) => {
            const body = document.querySelector(".readout tbody");
            return body?.dataset.spot === String(s) && body?.dataset.pixel === String(p);
        },
        [spot, pixel],
    );
    return page.$$eval(".readout data", (all) => Object.fromEntries(all.map((d) => [d.dataset.of, { value: Number(d.value), text: d.textContent }])));
}

after(close);

describe("the report of a run", () => {
    let page, browser, errors, about;
    before(async () => {
        ({ page, browser, errors } = await openPage(report));
        about = await page.$eval("#explorer-data", (e) => JSON.parse(e.textContent));
    });
    after(() => browser?.close());

    test("opens from disk without an error and asks for nothing else", async () => {
        assert.deepEqual(errors, []);
        assert.match(await page.textContent("#answer"), /agree/i);
    });

    test("20 random entries are those of the matrices on disk", async () => {
        const matrices = {
            traced: npy(join(run, "phi.npy")),
            "standard error": npy(join(run, "phi.stderr.npy")),
            doubt: npy(join(run, "phi.tails.npy")),
            modelled: npy(join(run, "model/phi.npy")),
            z: npy(join(run, "model/z.npy")),
        };
        const next = random(20);
        for (let i = 0; i < 20; i++) {
            const spot = Math.floor(next() * about.spots);
            const [column, row] = [Math.floor(next() * about.columns), Math.floor(next() * about.rows)];
            const pixel = column + row * about.columns;
            await slide(page, "#explorer-spot", spot);
            await slide(page, "#explorer-column", column);
            await slide(page, "#explorer-row", row);
            const shown = await readout(page, spot, pixel);
            for (const [name, matrix] of Object.entries(matrices)) {
                const truth = matrix.at(pixel, spot);
                assert.equal(shown[name].value, truth, `${name} of pixel ${pixel}, spot ${spot}`);
                assert.ok(Math.abs(parsed(shown[name].text) - truth) <= 0.0051 * Math.abs(truth), `${name}: ${shown[name].text} is not ${truth}`);
            }
            assert.equal(shown.residual.value, matrices.traced.at(pixel, spot) - matrices.modelled.at(pixel, spot));
        }
    });

    test("a z of 0 beside a difference is explained", async () => {
        const matrices = ["phi", "model/phi", "model/z", "phi.tails"].map((name) => npy(join(run, `${name}.npy`)));
        const entries = Array.from({ length: about.spots * about.columns * about.rows }, (_, i) => [i % about.spots, Math.floor(i / about.spots)]);
        const [spot, pixel] = entries.find(([l, p]) => matrices[2].at(p, l) === 0 && matrices[0].at(p, l) !== matrices[1].at(p, l));
        assert.notEqual(matrices[3].at(pixel, spot), 0, "left out by its code");
        await slide(page, "#explorer-spot", spot);
        await slide(page, "#explorer-column", pixel % about.columns);
        await slide(page, "#explorer-row", Math.floor(pixel / about.columns));
        assert.equal((await readout(page, spot, pixel)).z.value, 0);
        const line = () => page.textContent(".readout tr:last-child td");
        assert.match(await line(), /not counted, as its standard error is in doubt/);
        await slide(page, "#explorer-spot", spot === 0 ? 1 : 0);
        await readout(page, spot === 0 ? 1 : 0, pixel);
        assert.match(await line(), /standard errors$/);
    });

    test("sliders change the pictures, and the brightest pixel is where the matrix has it", async () => {
        const picture = (k) => page.$eval(`.frame:nth-child(${k}) .picture canvas`, (canvas) => [...canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data]);
        const phi = npy(join(run, "phi.npy"));
        const pictures = [];
        for (const spot of [0, about.spots - 1]) {
            await slide(page, "#explorer-spot", spot);
            await readout(page, spot, await page.$eval(".readout tbody", (b) => Number(b.dataset.pixel)));
            const colours = await picture(1);
            pictures.push(colours.join());
            // viridis grows lighter from its first colour to its last.
            const light = (pixel) => {
                const [x, y] = [pixel % about.columns, about.rows - 1 - Math.floor(pixel / about.columns)];
                const at = 4 * (x + y * about.columns);
                return 0.2126 * colours[at] ** 2.2 + 0.7152 * colours[at + 1] ** 2.2 + 0.0722 * colours[at + 2] ** 2.2;
            };
            const all = Array.from({ length: about.columns * about.rows }, (_, p) => p);
            const brightest = all.reduce((a, b) => (phi.at(b, spot) > phi.at(a, spot) ? b : a));
            const darkest = all.reduce((a, b) => (phi.at(b, spot) < phi.at(a, spot) ? b : a));
            const lights = all.map(light);
            assert.equal(lights[brightest], Math.max(...lights), `spot ${spot}`);
            assert.equal(lights[darkest], Math.min(...lights), `spot ${spot}`);
        }
        assert.notEqual(pictures[0], pictures[1]);
        const before = await picture(3);
        await page.check("text=one scale for traced");
        await page.waitForFunction((was) => {
            const canvas = document.querySelector(".frame:nth-child(3) .picture canvas");
            return [...canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data].join() !== was;
        }, before.join());
        await page.uncheck("text=one scale for traced");
    });

    test("a click on a spot of the drawing chooses it, a click into a frame its pixel", async () => {
        const spot = Math.floor(about.spots / 3);
        await page.locator(".plan .spots circle").nth(spot).dispatchEvent("click");
        const pixel = await page.$eval(".readout tbody", (b) => Number(b.dataset.pixel));
        await readout(page, spot, pixel);
        const canvas = page.locator(".frame .picture canvas").first();
        await canvas.scrollIntoViewIfNeeded();
        const box = await canvas.boundingBox();
        await page.mouse.click(box.x + (1.5 / about.columns) * box.width, box.y + box.height - (2.5 / about.rows) * box.height);
        await readout(page, spot, 1 + 2 * about.columns);
    });

    test("the keyboard alone reaches everything, and one sees where it is", async () => {
        const reached = await tabbed(page);
        const missed = await page.$$eval(
            "a[href], button, input, select, textarea, summary, [tabindex]",
            (all) => all.filter((e) => e.dataset.tabbed !== "yes" && !e.disabled && e.tabIndex >= 0 && e.getClientRects().length > 0).map((e) => e.outerHTML.slice(0, 120)),
        );
        assert.deepEqual(missed, []);
        assert.deepEqual(reached.filter((r) => !r.seen).map((r) => r.html), []);
        // And it moves what it has reached.
        await page.focus("#explorer-spot");
        const was = await page.inputValue("#explorer-spot");
        await page.keyboard.press("ArrowLeft");
        assert.notEqual(await page.inputValue("#explorer-spot"), was);
    });

    for (const colorScheme of ["light", "dark"]) {
        test(`axe-core finds no serious violation (${colorScheme})`, async () => {
            await page.emulateMedia({ colorScheme });
            assert.deepEqual(await axe(page), []);
        });
    }

    test("no error came later", () => assert.deepEqual(errors, []));
});

describe("pictures for people", { skip: pictures === undefined && "PHICAM_PICTURES is not given" }, () => {
    for (const [name, options] of Object.entries({
        desk: { width: 1280, height: 800 },
        "desk-dark": { width: 1280, height: 800, colorScheme: "dark" },
        tablet: { width: 820, height: 1180 },
        phone: { width: 360, height: 740 },
    })) {
        test(name, async () => {
            const { page, errors } = await openPage(report, options);
            mkdirSync(pictures, { recursive: true });
            await page.waitForTimeout(500);
            await page.screenshot({ path: join(pictures, `report-${name}.png`), fullPage: true });
            // Nothing is wider than the screen.
            assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), options.width);
            if (name === "desk") {
                await page.emulateMedia({ media: "print" });
                await page.pdf({ path: join(pictures, "report.pdf"), format: "A4", printBackground: true });
            }
            assert.deepEqual(errors, []);
        });
    }
});
