// The bench in three dimensions, in the page of a run.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { openPage } from "./browser.js";

const program = process.env.PHICAM ?? join(import.meta.dirname, "../../target/debug/phicam");
const folder = mkdtempSync(join(tmpdir(), "phicam-bench-"));

/** The page of a run of a built-in scene: made ready in the folder PHICAM_PAGES, or by a short run. */
function report(scene) {
    const ready = join(process.env.PHICAM_PAGES ?? folder, `${scene}.html`);
    if (existsSync(ready)) {
        return ready;
    }
    const out = join(folder, scene);
    if (!existsSync(out)) {
        // That model and light disagree, as behind a plank, is no failure here, nor that so few samples are no evidence.
        const { status } = spawnSync(program, ["run", scene, "-o", out, "--samples", "16", "--quiet"], { stdio: ["ignore", "ignore", "inherit"] });
        assert.ok([0, 1, 4].includes(status), `phicam run ${scene} ended with ${status}`);
    }
    return join(out, "report.html");
}

/** What a test that fails leaves open. */
const opened = [];

/** A page whose bench has been drawn and stands still. */
async function open(scene, options) {
    const { page, browser, errors } = await openPage(report(scene), options);
    opened.push(browser);
    const canvas = page.locator("#bench-3d canvas");
    await canvas.scrollIntoViewIfNeeded();
    await still(page);
    return { page, browser, errors, canvas };
}

/** Until the page has answered what was done to it, and the fine picture that follows the last moving one is there. */
async function still(page) {
    await page.waitForTimeout(150);
    await page.waitForFunction(() => document.querySelector(".bench-stage").dataset.still === "yes");
    await page.waitForTimeout(50);
}

/** What is on the screen of the drawing, without the names over it: a number per pixel, kept in the page. */
async function picture(page) {
    const style = await page.addStyleTag({ content: ".bench-names, .bench-scale { visibility: hidden }" });
    const png = await page.locator("#bench-3d canvas").screenshot();
    await style.evaluate((element) => element.remove());
    return page.evaluateHandle(async ([text, EDGE]) => {
        const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
        const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
        const canvas = new OffscreenCanvas(image.width, image.height);
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        // The outermost pixels are shared with the page where the drawing's edge is between two of them, and that differs with how far it is scrolled.
        const [width, height] = [image.width - 2 * EDGE, image.height - 2 * EDGE];
        return { width, values: new Uint32Array(context.getImageData(EDGE, EDGE, width, height).data.buffer) };
    }, [png.toString("base64"), 2]);
}

/** The box around the pixels in which two pictures differ, [left, top, right, bottom], and how many they are, and of how many. */
const difference = (page, a, b) =>
    page.evaluate(
        ([one, other]) => {
            const box = [Infinity, Infinity, -Infinity, -Infinity];
            let count = 0;
            one.values.forEach((value, i) => {
                if (value !== other.values[i]) {
                    const [x, y] = [i % one.width, Math.floor(i / one.width)];
                    [box[0], box[1], box[2], box[3]] = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x + 1), Math.max(box[3], y + 1)];
                    count++;
                }
            });
            return { box, count, all: one.values.length };
        },
        [a, b],
    );

const projection = async (canvas) => JSON.parse(await canvas.getAttribute("data-projection"));
const project = (rows, p) => rows.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
const block = (page) => page.evaluate(() => JSON.parse(document.getElementById("bench").textContent));
const chosen = (page) => page.locator(".bench-choice").textContent();

let first;
before(async () => {
    first = await open("bench");
});
after(async () => {
    await Promise.all(opened.map((browser) => browser.close()));
    rmSync(folder, { recursive: true, force: true });
});

test("the bench is drawn, and nothing is complained of", { timeout: 120_000 }, async () => {
    const counted = await (await picture(first.page)).evaluate(({ values }) => {
        const colours = {};
        values.forEach((value) => (colours[value] = (colours[value] ?? 0) + 1));
        return { colours, all: values.length };
    });
    const colours = new Map(Object.entries(counted.colours).map(([colour, count]) => [Number(colour), count]));
    assert.ok(colours.size > 50, `${colours.size} colours`);
    assert.ok(Math.max(...colours.values()) < 0.9 * counted.all, "nearly one colour");
    // The white and the black checks of the object.
    for (const check of [0xffffffff, 0xff000000]) {
        assert.ok((colours.get(check) ?? 0) > 500, check.toString(16));
    }
    assert.deepEqual(first.errors, []);
});

test("keys and a drag turn it, Home starts again", { timeout: 120_000 }, async () => {
    const { page, canvas } = first;
    // The ring of the focus is in the picture.
    await canvas.focus();
    await page.keyboard.press("Shift");
    const start = await picture(page);
    for (const key of ["ArrowLeft", "ArrowUp", "+"]) {
        const before = await picture(page);
        await page.keyboard.press(key);
        await still(page);
        assert.ok((await difference(page, before, await picture(page))).count > 1000, key);
    }
    await page.keyboard.press("Home");
    await still(page);
    assert.equal((await difference(page, start, await picture(page))).count, 0);
    const { x, y, width, height } = await canvas.boundingBox();
    const spot = await chosen(page);
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2 + 90, y + height / 2 + 20, { steps: 6 });
    await page.mouse.up();
    await still(page);
    assert.ok((await difference(page, start, await picture(page))).count > 1000);
    assert.equal(await chosen(page), spot, "a drag chooses nothing");
    await page.getByRole("button", { name: "3-D" }).click();
    await still(page);
});

/** The wall of the bench is 11.5 in. by 15.5 in. in the plane z = 0 (design.md, 1): measured on the screen, where it is what differs when the walls are hidden. */
test("the views along the axes are to scale", { timeout: 120_000 }, async () => {
    const { page, canvas } = first;
    await page.getByRole("button", { name: "Top (x, y)" }).click();
    await still(page);
    const whole = await picture(page);
    const walls = page.getByLabel("walls (relay)");
    await walls.uncheck();
    await still(page);
    const { box } = await difference(page, whole, await picture(page));
    await walls.check();
    // The outline is 2 px wide, half of it outside.
    const [width, height] = [box[2] - box[0] - 2, box[3] - box[1] - 2];
    assert.ok(Math.abs(width / height / (11.5 / 15.5) - 1) < 0.008, `${width} ${height}`);
    const rows = await projection(canvas);
    const [o, a, b] = [[0, 0, 0], [11.5, 0, 0], [0, 15.5, 0]].map((p) => project(rows, p));
    assert.ok(Math.abs(a[0] - o[0] - width) < 2 && Math.abs(o[1] - b[1] - height) < 2);
    assert.ok(Math.abs(a[1] - o[1]) < 0.01 && Math.abs(b[0] - o[0]) < 0.01, "x to the right, y upwards");
    const bar = await page.locator(".bench-scale i").evaluate((line) => parseFloat(line.style.width));
    const length = parseFloat(await page.locator(".bench-scale span").textContent());
    assert.ok(Math.abs(bar / length / (width / 11.5) - 1) < 0.01, `${length} in. are ${bar} px`);
    // From the side and from the front: the axes named on the button, to one scale.
    for (const [name, across, up] of [["Side (y, z)", 1, 2], ["Front (x, z)", 0, 2]]) {
        await page.getByRole("button", { name }).click();
        await still(page);
        const [right, down] = await projection(canvas);
        assert.ok(right[across] > 1 && Math.abs(down[up] / right[across] + 1) < 1e-6, name);
        assert.ok(Math.abs(right[up]) < 1e-6 * right[across] && Math.abs(down[across]) < 1e-6 * right[across], name);
    }
    await page.getByRole("button", { name: "3-D" }).click();
    await still(page);
});

test("a click chooses the spot under it, on the wall in view its pixel", { timeout: 120_000 }, async () => {
    const { page, canvas } = first;
    const { camera } = await block(page);
    await page.getByRole("button", { name: "Top (x, y)" }).click();
    await still(page);
    const before = await picture(page);
    // The layout of design.md, 6: bottom by growing x, right by growing y, top by falling x, left by falling y, 30 each; every third one staggered.
    const [x0, y0, n] = [5, 4.373476808130942, 30];
    const side = Array.from({ length: n }, (_, k) => [-3 + (6 * k) / (n - 1), [-1, 1, 0][k % 3]]);
    const places = [
        ...side.map(([t, off]) => [x0 + t, y0 - 3 + off, 0]),
        ...side.map(([t, off]) => [x0 + 3 + off, y0 + t, 0]),
        ...side.map(([t, off]) => [x0 - t, y0 + 3 + off, 0]),
        ...side.map(([t, off]) => [x0 - 3 + off, y0 - t, 0]),
    ];
    const rows = await projection(canvas);
    for (let spot = 0; spot < places.length; spot += 7) {
        const [x, y] = project(rows, places[spot]);
        await canvas.click({ position: { x, y } });
        assert.match(await chosen(page), new RegExp(`^Spot ${spot} at`));
    }
    await still(page);
    assert.ok((await difference(page, before, await picture(page))).count > 200, "the beams follow");
    const [column, row] = [11, 6];
    const place = [0, 1, 2].map((i) => camera.corner[i] + (camera.u[i] * (column + 0.5)) / 16 + (camera.v[i] * (row + 0.5)) / 16);
    const [x, y] = project(rows, place);
    await canvas.click({ position: { x, y } });
    assert.match(await chosen(page), /Pixel 107 \(column 11, row 6\)/);
    await page.getByRole("button", { name: "3-D" }).click();
    await still(page);
});

test("every tick box hides something, and shows it again", { timeout: 120_000 }, async () => {
    const { page, browser } = await open("shelf");
    const whole = await picture(page);
    const boxes = page.locator(".bench-parts input");
    assert.equal(await boxes.count(), 6);
    for (const box of await boxes.all()) {
        await box.uncheck();
        await still(page);
        assert.ok((await difference(page, whole, await picture(page))).count > 100, await box.getAttribute("name"));
        await box.check();
        await still(page);
        assert.ok((await difference(page, whole, await picture(page))).count < 5, "as before, but for single dots");
    }
    await browser.close();
});

test("the wheel scrolls the page until the drawing is clicked", { timeout: 120_000 }, async () => {
    const { page, browser, canvas } = await open("bench");
    const [scale, scrolled] = [async () => (await projection(canvas))[0], () => page.evaluate(() => scrollY)];
    await canvas.hover();
    const [far, top] = [await scale(), await scrolled()];
    await page.mouse.wheel(0, 120);
    await still(page);
    assert.ok((await scrolled()) > top);
    assert.deepEqual(await scale(), far);
    await canvas.scrollIntoViewIfNeeded();
    await canvas.click({ position: { x: 5, y: 5 } });
    const here = await scrolled();
    await page.mouse.wheel(0, -120);
    await still(page);
    assert.equal(await scrolled(), here);
    assert.notDeepEqual(await scale(), far);
    await browser.close();
});

test("on a phone a finger scrolls the page upwards and turns the bench sideways", { timeout: 120_000 }, async () => {
    const { page, browser, canvas, errors } = await open("bench", { width: 360, height: 740, hasTouch: true, isMobile: true, deviceScaleFactor: 2 });
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360, "nothing sticks out");
    const session = await page.context().newCDPSession(page);
    const swipe = async (dx, dy) => {
        const { x, y, width, height } = await canvas.boundingBox();
        const touch = (type, share) => {
            const point = { x: x + width / 2 + dx * share, y: y + height / 2 + dy * share };
            return session.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [point] });
        };
        await touch("touchStart", 0);
        for (let i = 1; i <= 15; i++) {
            await touch("touchMove", i / 15);
            await page.waitForTimeout(20);
        }
        await touch("touchEnd", 1);
        await still(page);
    };
    const turned = async (from) => (await projection(canvas))[0].some((x, i) => Math.abs(x - from[i]) > 1e-6);
    const [[across], top] = [await projection(canvas), await page.evaluate(() => scrollY)];
    await swipe(0, -150);
    assert.ok((await page.evaluate(() => scrollY)) > top + 100);
    assert.ok(!(await turned(across)));
    await canvas.scrollIntoViewIfNeeded();
    const here = await page.evaluate(() => scrollY);
    await swipe(120, 0);
    assert.equal(await page.evaluate(() => scrollY), here);
    assert.ok(await turned(across));
    assert.deepEqual(errors, []);
    await browser.close();
});

test("without WebGL the static drawing stays, and a note says why", { timeout: 120_000 }, async () => {
    const { page, browser, errors } = await openPage(report("bench"), { args: ["--disable-gpu", "--disable-webgl", "--disable-3d-apis"] });
    opened.push(browser);
    assert.match(await page.locator("#bench-3d").textContent(), /no WebGL/);
    assert.equal(await page.locator("#bench-3d canvas").count(), 0);
    assert.ok(await page.locator("figure.bench svg").isVisible());
    assert.deepEqual(errors, []);
    await browser.close();
});

test("on paper the static drawing stands alone", { timeout: 120_000 }, async () => {
    const { page } = first;
    await page.emulateMedia({ media: "print" });
    assert.ok(!(await page.locator("#bench-3d").isVisible()));
    assert.ok(await page.locator("figure.bench svg").isVisible());
    await page.emulateMedia({ media: null });
});

test("in dark colours it is drawn anew", { timeout: 120_000 }, async () => {
    const { page } = first;
    await still(page);
    const light = await picture(page);
    await page.emulateMedia({ colorScheme: "dark" });
    await still(page);
    const dark = await picture(page);
    const { count, all } = await difference(page, light, dark);
    assert.ok(count > 0.9 * all);
    await page.emulateMedia({ colorScheme: "light" });
    await still(page);
    assert.equal((await difference(page, light, await picture(page))).count, 0);
});
